/* A plan: what its robots tell about the targets, and the value of a set of them. */
#ifndef RATT_TEAM_H
#define RATT_TEAM_H

#include <stddef.h>
#include <stdint.h>

enum { TRACE = 0, LOG_DET = 1, LARGEST = 2 }; /* compiled_code of the criteria */
enum { LARGEST_DIMENSION = 64 };

/* Symmetric matrices are packed by rows of the lower triangle: entries = d (d + 1) / 2. */
typedef struct {
    int32_t robots, targets, dimension, criterion;
    const double *weights;     /* (targets) */
    const double *prior;       /* (targets, entries) prior information */
    const double *information; /* (robots, targets, entries) */
    const double *before;      /* (targets) each target's criterion without measurements, from `criteria_before` */
    double before_all;         /* the weighted criterion without measurements where it is the largest eigenvalue */
    double relative, rounding; /* an improvement counts if it exceeds this share of a value, and the rounding of values */
} Team;

/* Smallest improvement of a value that is more than rounding: SetFunction.least_improvement. */
double least_improvement(const Team *team, double value);

int entries_of(const Team *team);

/* The trace of the inverse of a packed positive definite matrix, and the logarithm of its determinant. */
double trace_of_inverse(int dimension, const double *matrix);
double log_determinant(int dimension, const double *matrix);

/* Rotate a symmetric matrix until what is left beside its diagonal is rounding; `axes`, unless it is NULL, become its
   columns' axes where it was the unit matrix. */
void diagonalise(int dimension, double matrix[][LARGEST_DIMENSION], double axes[][LARGEST_DIMENSION]);

/* out = sums + times * information of a robot, all (targets, entries); `out` may be `sums`. */
static inline void add_information(const Team *team, const double *sums, double times, int64_t robot, double *out) {
    int width = team->targets * entries_of(team);
    const double *own = team->information + (size_t)robot * width;
    for (int t = 0; t < width; t++) out[t] = sums[t] + times * own[t];
}

/* Value of the posterior information `sums` (targets, entries). */
double value_of(const Team *team, const double *sums);

/* Values of `width` matrices at once: sums (targets, entries, width), to each of which `offset` (targets, entries) is
   added; `spare` (width). */
void values_of(const Team *team, int width, const double *sums, const double *offset, double *values, double *spare);

#endif
