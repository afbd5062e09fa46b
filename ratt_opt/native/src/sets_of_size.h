/* Sets of given sizes that are worth little: searches, exchanges of robots, disjoint sets. */
#pragma once
#include "team.h"

/* Progress of a round of exchanges, and the best one so far: that robot `leaves` and `enters`; -1 if none.
   `lowest` is INFINITY before the first. */
typedef struct {
    int64_t next, leaves, enters;
    double lowest;
} Scan;

/* A search of sets of one size: worth less than `threshold` with what `start` tells, and cheaper than `limit`. */
typedef struct {
    const Team *team;
    double threshold, level, limit; /* its level, rounding included */
    int64_t size;
    const double *start;            /* (targets, entries) the prior's information and that of robots chosen already */
    int64_t candidates, in_order;   /* are candidates decided in the order given? */
    const int64_t *order;           /* (candidates) robots that may be in a set, distinct */
    const double *costs;            /* (robots), or NULL */
} SetQuestion;

/* An open search of sets. */
typedef struct SetSearch SetSearch;

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

EXPORTED void close_sets(SetSearch *s);
/* Begin a search, whose question is kept alive by others; NULL where memory is short. The threshold, its level and the limit
   may be lowered between two calls. */
EXPORTED SetSearch *open_sets(SetQuestion *question);
/* Go on for so many partial sets, or to the next set: 0 all are decided, 1 paused, 2 found. `chosen` (robots). */
EXPORTED int next_set_below(SetSearch *s, int64_t nodes, uint8_t *chosen, double *value, int64_t *progress);
/* List sets from number *count on, at most as many as there is room for: masks (bit i for robot i, at most 64 robots), values.
   0 all are decided, else 1. `chosen` (robots) is spare. */
EXPORTED int list_sets_below(SetSearch *s, int64_t nodes, int64_t room, uint8_t *chosen, uint64_t *masks, double *values, int64_t *count,
                             int64_t *progress);
/* A value that no set which is still open is below, unless it is at least the threshold. */
EXPORTED double least_open(const SetSearch *s);
/* Exchange a robot of the best group for one elsewhere, the best pair each time, while the best group weakens. `home`
   (robots): group of each from 1 on, 0 in none, -1 if it stays so; `must` (robots): it stays in some group. *value: of the
   best group; returns 1 at the end, 0 after about so many `pairs` (the next call with the same `scan` goes on there), -1
   where memory is short. */
EXPORTED int exchange_groups(const Team *team, int groups, int64_t *home, const uint8_t *must, double share, int64_t pairs, Scan *scan,
                             double *value);
/* Go on until all is decided (1), or so many sets were looked at (0). The threshold falls to the value of what is found. */
EXPORTED int search_disjoint(DisjointSets *d, int64_t work);
