/* Sets of the elements that tell about one target: which one is worth most beyond prices of its elements. */
#pragma once
#include "team.h"

/* The elements that tell about one target, robot by robot. Symmetric matrices are packed as in team.h. */
typedef struct {
    int32_t robots, dimension, criterion; /* at most 64 robots; trace in the line and in the plane only */
    double weight, baseline;              /* of the criterion, and the weighted criterion of the prior information */
    double error;                         /* by which a difference of two values may be off */
    const int64_t *first;                 /* (robots + 1) where the elements of each robot begin */
    const double *prior, *information;    /* (entries), (elements, entries) */
} Seers;

/* No set of at most one element of each robot is worth more beyond its elements' prices, or the `floor` if that is more;
   such a set is worth as much to within `tolerance`. Infinite after `most` nodes. `chosen` (robots) : the elements of the
   best set found, or -1; all -1 if none exceeds the floor. */
EXPORTED double largest_excess(const Seers *seers, const double *prices, double floor, double tolerance, int64_t most, int64_t *chosen);
