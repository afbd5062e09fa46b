/* Groups of small reduced cost: an exact search, annealing, proofs that there is none. */
#pragma once
#include "team.h"

/* A search for groups of small reduced cost: unit * links that leave it - duals of its robots + blinding * robots blinded is less
   than `limit`, and blinding at most n_blinded of its robots leaves less than the threshold. Arcs as in `Anneal`. */
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

/* A row of a tree over sets: any `size` of the `count` robots in the search's row of order are worth the threshold with those in `sensing`;
   those before `first` do not sense. */
typedef struct {
    uint64_t sensing; /* if limits close rows */
    int32_t count, first, size;
} Row;

/* An open search of groups. */
typedef struct Search Search;

EXPORTED void close_pricing(Search *s);
/* Begin a search, whose arrays are kept alive by others; NULL where memory is short. */
EXPORTED Search *open_pricing(const Pricing *question);
/* Go on for so many nodes, until all are decided (0) or `room` groups are listed; their number is *count. `groups` (room, robots):
   0 outside, 1 sensing, 2 blinded; `columns` (room, 4): blinded robots at least and as found, links that leave it, reduced
   cost. `progress`: nodes so far. */
EXPORTED int list_groups_below(Search *s, int64_t nodes, int64_t room, int8_t *groups, int64_t *columns, int64_t *count, int64_t *progress);
/* The most robots of a group that may be below the threshold, at most as many as the search is told. */
EXPORTED int64_t most_below(Search *s, const uint8_t *group);
/* Anneal a group that has the robot `first`, between two temperatures in units of duals. `best` (robots): 0 outside, 1
   sensing, 2 blinded. Returns its reduced cost, or one that none has where there is no such group or memory is short. */
EXPORTED int64_t anneal_column(const Pricing *q, int64_t first, int64_t moves, double hot, double cold, uint64_t *random, int8_t *best);
/* Write a tree that any `size` robots of those in `among` (robots) are worth the threshold, on from `*depth`, or from its root if
   that is -1: 0 it is finished, 1 paused once so many robots were valued, 2 too large for the arrays, 3 some set is worth less. */
EXPORTED int grow_sets_tree(Search *s, GroupTree *out, const int8_t *among, Row rows[], int32_t *depth, int64_t size, int64_t effort);
/* Grow a tree for so many cases: 0 it is finished, 1 paused, 2 too large for the arrays, 3 some group is not closed. */
EXPORTED int grow_group_tree(Search *s, GroupTree *out, int64_t cases);
