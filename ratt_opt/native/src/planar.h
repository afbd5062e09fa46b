/* Planar targets: gains of the greedy algorithm, contexts of an element. */
#pragma once
#include "team.h"

/* Gains of the greedy algorithm. Planar matrices [[a, b], [b, c]] as rows of a, of b and of c, so that
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

/* Gains and bounds of those candidates whose gain may come within `close` of the largest, which is `best` so far; returns
   the largest. */
EXPORTED double evaluate_gains(const Greedy *g, const int64_t *candidates, int64_t count, double close, double best);
/* Give each owner in turn its best option beside the others'; whether any has changed. */
EXPORTED int descend(Descent *d);
/* Give owner i and each later one in turn the best pair of options beside the others'. */
EXPORTED void descend_pairs(Descent *d, int64_t i);
/* sums, sizes (count, width): over owners (options, ascending), of the largest `levels - slope * own` of their options, and of
   its absolute value; levels (count, options), slopes (count), own (options, width); `best` (width) is spare. */
EXPORTED void sum_ceilings(int64_t count, int64_t options, int64_t width, const int64_t *owners, const double *levels, const double *slopes,
                           const double *own, double *best, double *sums, double *sizes);
