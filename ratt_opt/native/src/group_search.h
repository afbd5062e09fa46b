/* The search for a group of negative reduced cost, shared by the files of pricing. */
#pragma once
#include "pricing.h"

static const double ROUNDING = 1e-10; /* relative: averages must be higher to prove anything */

/* What a robot may still be to the group, as bits; OUTSIDE alone and without OUTSIDE are decided. */
enum { SENSES = 1, BLINDED = 2, OUTSIDE = 4 };

#define IS_INSIDE(state) (!((state) & OUTSIDE))
#define MAY_SENSE(state) (((state) & SENSES) && (state) != SENSES)

/* Multipliers of what every group of a node keeps, in links. */
typedef struct {
    double value, blinded, cut;
} Multipliers;

/* An open node: groups with what each robot may be. */
typedef struct {
    int8_t *state;        /* (robots) */
    uint8_t *blind;       /* (robots) blinded robots that leave what is inside below the threshold */
    double *sums, *worth; /* (targets, entries) of robots that sense for sure; (robots) value with one more of them */
    int need, found;      /* blinded robots: at least, and in `blind` */
    int most;             /* robots that sense, at most */
    int low, high;        /* robots inside */
    int64_t cut;          /* links that leave a group of so many robots, at least */
    Multipliers at;
} Node;

struct Search {
    Pricing q;
    int robots, width;
    double before;                /* error without a robot */
    Node *nodes;
    int depth, first;
    int64_t visited;
    int64_t *excess, *capacity, *cost; /* of the flow */
    int *distance, *queue, *next, *order;
    double *weight, *sorted, *spare, *sums; /* (robots) twice; (width); (robots + 2, width + robots) */
    uint8_t *inside, *sense, *chosen;  /* (robots) */
};

/* pricing.c */
/* The least reduced cost of the node's groups, for these multipliers; `room`: what those who may sense weigh at most. */
double bound_of(Search *s, const Node *node, Multipliers at, double room);
/* Better multipliers, by a subgradient step from a bound towards the limit; 0 where the group at hand keeps everything. */
int improve(const Search *s, const Node *node, Multipliers *at, double room, double bound);
/* An open robot next to the group, with the most links to decided ones; -1 where there is none. */
int next_to_group(const Search *s, const int8_t *state);
/* The node with every group. */
Node *begin(Search *s);
void copy_node(const Search *s, const Node *from, Node *to);

/* levels.c */
/* The sum of the `count` least of `values` (length), which are sorted in place. */
double sum_of_least(double *values, int length, int count);
double error_before(const Team *team);
double value_of_copies(const Search *s, const double *sums, double times, int i);
double level_of_copies(const Search *s, const double *sums, double times, int i);
/* What the robots of a node that may sense weigh, in `weight`; lowers `most` and closes robots that cannot sense. Returns the
   most that those of a set below the threshold weigh besides robots that sense for sure. `fresh`: more of these than before. */
double weigh(Search *s, Node *node, int fresh);

/* needs.c */
int may_be_below(Search *s, Node *node, int blinded, int64_t effort); /* 1 yes, 0 no, -1 unknown */
int admit(Search *s, Node *node, int robot);
void settle(Search *s, Node *node);

/* flow.c */
/* Least cost of links, `link` each, and robots over the groups of states; its group is `inside`. */
int64_t least_cut(Search *s, const int8_t *state, int64_t link);
