/* Annealed attacks and cuts. */
#pragma once
#include "team.h"

/* An annealed attack; arcs of robot i are start[i]..start[i + 1] - 1. */
typedef struct {
    const Team *team;
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

/* Anneal a state that is within the budgets, in place, from step `first` to `last` of `steps`. A state that leaves less than
   *least, the value of its largest group (groups may be disconnected: the attack leaves no more), is kept. 1 where memory
   is short, else 0. */
EXPORTED int anneal(const Anneal *a);
/* Go through the moves first..last - 1 of `moves`. Groups within the size that cut less than `fewest` links are kept; returns
   the fewest. */
EXPORTED int64_t anneal_cut(const CutAnneal *a, int64_t first, int64_t last, int64_t moves, int64_t fewest);
