/* Elements that robots choose from: what each tells about the targets, and what is gained by that (trace, log-det). */
#pragma once
#include "team.h"

/* Elements and the targets. Symmetric matrices are packed as in team.h. */
typedef struct {
    int64_t elements, targets, entries; /* entries = dimension (dimension + 1) / 2 */
    int32_t dimension, criterion;
    const double *weights;     /* (targets) */
    const double *baseline;    /* (targets) weighted criterion of the prior information */
    const double *prior;       /* (targets, entries) prior information */
    const double *information; /* (elements, targets, entries) */
    const uint8_t *sees;       /* (elements, targets) whether there is information */
    double relative, rounding; /* as in team.h */
} Elements;

/* The elements with the robots that choose: at most 64 each, so that a mask of 64 bits holds a set of them. */
typedef struct {
    Elements all;
    int64_t robots, widest;
    const int64_t *owner, *place; /* (elements) the robot, and the element's bit in the robot's masks */
    const int64_t *element;       /* (robots, widest) the element of each bit, or -1 */
    const double *count;          /* (robots) what a robot counts in a cover; covers ask for `enough` */
    const uint8_t *safe;          /* (robots) whether it cannot be blinded */
    double enough;
} Choices;

/* Entries of all targets' matrices together. */
static inline int64_t width_of(const Elements *all) { return all->targets * all->entries; }

static inline const double *information_of(const Elements *all, int64_t element, int64_t target) {
    return all->information + element * width_of(all) + target * all->entries;
}

static inline int sees(const Elements *all, int64_t element, int64_t target) { return all->sees[element * all->targets + target]; }

/* What is gained about a target whose posterior information is a packed matrix. */
double gained(const Elements *all, int64_t target, const double *matrix);

/* The sum over targets; `sums` (targets, entries); `values` (targets) is set to what is gained about each. */
double gained_in_all(const Elements *all, const double *sums, double *values);

/* out = A + (B - A)_+ : no smaller than either of two packed matrices. `out` may be A. */
void raised(int dimension, const double *first, const double *second, double *out);

/* Set `bound` (targets, entries) to no less than what any element of a robot's mask tells. */
void bound_robot(const Choices *choices, int64_t robot, uint64_t mask, double *bound);

/* `bounds` (robots, targets, entries) of what the elements of masks (robots) tell. */
EXPORTED void bound_robots(const Choices *choices, const uint64_t *masks, double *bounds);
/* What groups gain about each target, `values` (groups, targets), where their robots tell `bounds`;
   `members` (groups, robots). */
EXPORTED void group_values(const Choices *choices, const double *bounds, int64_t groups, const uint8_t *members, double *values);
