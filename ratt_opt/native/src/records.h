/* Records that Python makes and C reads and writes. */
#ifndef RATT_RECORDS_H
#define RATT_RECORDS_H

#include <stdint.h>

#include "team.h"

/* How far the exchanges of one round were looked at, and the best one so far: that robot `leaves` and `enters`; -1 if none.
   `lowest` is INFINITY before the first. */
typedef struct {
    int64_t next, leaves, enters;
    double lowest;
} Scan;

/* A node of the list of groups: robots inside, robots outside, those next to one inside; links between the first two. */
typedef struct {
    uint64_t inside, outside, near;
    int64_t cut;
} Branch;

/* A level of the search of covers. */
typedef struct {
    int64_t room[3];                   /* reduced cost, blinded robots and links that are left */
    int64_t start, end, position;      /* of the columns that fit, in `fitting` */
    int32_t robot, column;             /* the robot that is covered next, -1 until chosen; the column tried */
} Level;

/* A search of covers. Columns are sorted by reduced cost. */
typedef struct {
    int64_t robots, words, room;       /* `words` of 64 robots each; `room` for columns that fit */
    const uint64_t *groups;            /* (columns, words) */
    const int64_t *costs;              /* (columns, 3) reduced cost, blinded robots, links, each >= 0 */
    int32_t *fitting;                  /* (room) those that fit at each level, one after the other */
    Level *levels;                     /* (robots + 2) */
    uint64_t *left;                    /* (robots + 2, words) robots not covered */
    int64_t *counts;                   /* (robots) spare */
    int64_t depth, nodes, most_nodes;  /* depth -1 at the end; nodes so far, and before a pause */
} Cover;

/* Groups that an attack may leave; as bit masks of 64 bits where they are `wide`, of 32 elsewhere. */
typedef struct {
    int64_t count, wide;
    void *groups;
    uint8_t *cuts, *blinded;           /* links that leave each, and robots to blind in it */
} Columns;

enum { PART = 12 };

/* Integer duals, in units of a link: `sums` over sets of the first PART robots, of the next, and so on; `unit` of a link,
   `blinding` of a blinded robot. */
typedef struct {
    const int64_t *sums;               /* (parts, 2**PART) */
    int64_t unit, blinding;
} Duals;

/* An annealed attack; arcs of robot i are start[i]..start[i + 1] - 1. */
typedef struct {
    const double *table;               /* values of all sets, or NULL */
    const Team *team;                  /* where there is no table */
    int64_t robots, budget;            /* links that may be cut */
    const int64_t *start, *robot;      /* (robots + 1); (arcs) the other end */
    const uint8_t *fixed, *seeing;     /* (arcs), (robots) what cannot be cut, or blinded */
    int64_t *group, *best_group;       /* (robots) */
    uint8_t *blind, *best_blind;       /* (robots) */
    int64_t first, last, steps;
    double hot, cold;                  /* temperatures at the first and after the last step */
    double *least;
    uint64_t *random;                  /* not 0 */
} Anneal;

/* An annealed cut that leaves no group with more than `most` robots; arcs as in `Anneal`. */
typedef struct {
    int64_t robots, groups, most;
    const int64_t *start, *robot;
    const int64_t *price, *counts;     /* (arcs) of a cut; (robots) sizes, 0 for those that do not count */
    int64_t *group, *best;             /* (robots) labels of groups; the same where the fewest links were cut */
    int64_t *sizes;                    /* (groups) sums of `counts` */
    double hot, cold, oversize;        /* temperatures at the first and after the last move; the price of a robot too many */
    void *random;                      /* NumPy's source of random bits, and its function for doubles in [0, 1) */
    double (*uniform)(void *random);
} CutAnneal;

/* Groups that keep more link weight than their robots' prices. */
typedef struct {
    int64_t robots, links;
    const int64_t *ends;               /* (links, 2) */
    const int64_t *start, *arc;        /* (robots + 1) of each robot's links in `arc` (2 links) */
    const int64_t *weight;             /* (links) in units of prices */
    const int64_t *price, *size;       /* (robots) */
    int64_t room, threshold, listing;  /* sizes and values of groups that are found; listing: all of them, each once */
    int64_t most_found, found;
    uint8_t *groups;                   /* (most_found, robots) */
    int64_t *values;                   /* (most_found) */
    int64_t most_length, length;       /* of `tree`, the proof that there is no such group; 0: none is written */
    int64_t *tree;
    int64_t nodes;
} KeptLinks;

/* What the next choices of the greedy algorithm add; planar matrices [[a, b], [b, c]] as rows of a, of b and of c, so that
   targets lie side by side. Rows have `width` places: behind the targets come ones that add nothing (trace, log-det). */
typedef struct {
    int64_t criterion, targets, width;
    const double *weights;     /* (width) */
    const double *information; /* (elements, 3, width) */
    const double *sums;        /* (3, width) the posterior information so far */
    const double *covariances; /* (4, width) its inverse; the largest eigenvalues of that */
    const int64_t *order;      /* (targets) the largest weighted eigenvalue first */
    double *bounds;            /* (elements) what no later gain exceeds */
    double *gains;             /* (elements) */
} Greedy;

/* Descent over the contexts of one element: planar targets by their mean, even and odd parts, (3, targets). */
typedef struct {
    int64_t owners, targets;
    double sign, value;        /* -1 for the largest marginal, which is then negated; the marginal in the context */
    double relative, rounding; /* as in `Team`, of marginals */
    const double *parts;       /* (options, 3, targets) */
    const int64_t *ends;       /* (owners + 1) the first option of each owner */
    const double *added;       /* what the element adds */
    double *total;             /* of the context */
    int64_t *picks;            /* (owners) the option of each owner in the context */
    double *rest, *one;        /* spare */
} Descent;

/* A search for groups whose reduced cost, unit * links that leave it - duals of its robots + blinding * robots blinded, is less
   than `limit`, and of which blinding at most n_blinded leaves less than the threshold. Arcs as in `Anneal`. */
typedef struct {
    const Team *team;
    double threshold, level;             /* its level, rounding included */
    int64_t n_blinded, most_cut, most;   /* of one group: blinded robots, links; robots that sense */
    const int64_t *start, *robot, *back; /* (arcs) `back`: the same link's arc the other way */
    const uint8_t *fixed, *seeing;
    const int64_t *least_cut;            /* (robots + 1) links that leave a group of so many robots, at least */
    const int64_t *duals;                      /* (robots) */
    const int64_t *order;                /* (robots) */
    int64_t blinding, unit, limit;
    int64_t effort;                      /* robots valued to decide what a group needs */
    double *levels;                      /* (most of all + 1, robots, robots), or NULL: levels of copies of two robots */
    int32_t *near;                       /* the same; the other robots by level */
    uint8_t *filled;                     /* (most of all + 1) */
} Pricing;

/* A tree of cases that is written for a proof: nodes in preorder, each what it says and a number. */
typedef struct {
    int64_t limit;                       /* groups that cost more are closed; with 0 or more, others are listed */
    int64_t averages;                    /* whether a checker takes averages of values */
    int64_t count, capacity;             /* of nodes */
    int64_t n_flows, most_flows;
    int64_t n_listed, most_listed;
    int64_t *nodes;                      /* (capacity, 2) */
    int64_t *flows, *recent;             /* (most_flows, 2 + arcs) prices of blinding and of cuts, flows; (most_flows) */
    int8_t *listed;                      /* (most_listed, robots) who is inside */
    int64_t *needs;                      /* (most_listed) blinded robots, at least */
    int64_t n_limits;
    uint64_t *limited;                   /* (n_limits) whose robots; teams of up to 64 have limits */
    int64_t *most, *uses;                /* (n_limits) how many of them sense at most; nodes that say so */
} GroupTree;

/* An open search. */
typedef struct Search Search;

/* Sets of `size` robots that are worth less than `threshold` with what `start` tells, and cost less than `limit`. */
typedef struct {
    const Team *team;
    double threshold, level, limit; /* its level, rounding included */
    int64_t size;
    const double *start;            /* (targets, entries) the prior's information and that of robots chosen already */
    int64_t candidates, in_order;   /* are candidates decided in the order given? */
    const int64_t *order;           /* (candidates) robots that may be in a set, distinct */
    const double *costs;            /* (robots), or NULL */
} SetQuestion;

/* A level of the search of disjoint sets. */
typedef struct {
    uint64_t decided, rest;
    int64_t next, chosen;
    double cost, value;      /* of the sets so far: costs, the largest value */
    int32_t *counts;         /* (classes) sets to come */
    int32_t option, places, kept, unused; /* class tried, -1 before the first; places in the rest, and those not blinded */
} Choice;

/* Disjoint sets from lists, by their first robots and cheapest first: those of class c and robot r are
   starts[c * (robots + 1) + r].. up to the next start. */
typedef struct {
    int64_t robots, classes, rest, n_blinded; /* robots in no set; of these, blinded */
    const uint64_t *masks;
    const double *values, *costs;
    const int64_t *starts;
    const double *rest_costs, *single;        /* (robots) */
    uint64_t must;                            /* robots that cannot be blinded */
    double threshold, room;
    int64_t remembered, depth, found;         /* remembered: a power of 2 */
    uint64_t *memory;                         /* (remembered, 2) */
    Choice *stack;                            /* (robots + 2) */
    int64_t *best;
} DisjointSets;

/* An open search of sets. */
typedef struct SetSearch SetSearch;

#endif
