/* The search by marginal gains: the team in the order in which robots choose, known attacks, and the way down. */
#pragma once
#include "elements.h"

/* The elements of robots, both in the order in which robots choose. */
typedef struct {
    Elements all;
    int64_t robots;
    const int64_t *first;   /* (robots + 1) where each robot's elements begin */
    const int64_t *seeing;  /* (targets, elements) elements with information of a target, the last first, ended by -1 */
} Choosers;

/* Attacks whose groups have no blinded robots. */
typedef struct {
    int64_t attacks, widest;
    const uint64_t *members; /* (groups) masks of robots */
    const int64_t *of;       /* (attacks, widest) groups that each leaves, or -1 */
    int64_t *order;          /* (attacks) in which they are tried; those that last led to a dead end come first */
} Attacks;

/* Place of the search. */
typedef struct {
    int64_t depth, size; /* robots that have chosen; nodes recorded */
    int64_t *chosen;     /* (robots) their elements */
    uint64_t *seers;     /* (targets) masks of the robots that have chosen to see a target */
    int64_t *version;    /* (targets) another one at each change */
    int32_t *record;     /* of each node, in preorder: the attack that makes it a dead end, or BRANCHED */
} Path;

/* Values and gains of each target beside the last sets of its seers. */
typedef struct {
    int64_t sets;
    double *value;    /* (targets, sets) what they gain */
    double *gain;     /* (targets, sets, elements) what elements gain beside them, of robots that choose later than */
    int64_t *since;   /* (targets, sets) */
    int64_t *version; /* (targets, sets), as of the path, */
    uint64_t *seers;  /* and the set */
    int64_t *slot;    /* (targets) where the set asked for is */
} Gains;

/* Search on for so many nodes, for which the record has room; the outcome. At a node where robots have not chosen yet
   `most` attacks are tried. A plan that is worth more than the level by less than `slack` is not found. */
EXPORTED int dive_by_marginals(const Choosers *team, Attacks *attacks, Gains *gains, Path *path, double level, double slack, int64_t nodes,
                               int64_t most);
