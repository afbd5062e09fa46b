/* A plan: what its robots tell about the targets, and the value of a set of them. */
#pragma once
#include <stddef.h>

#include "sets.h"

enum { TRACE = 0, LOG_DET = 1, LARGEST = 2 }; /* compiled_code of the criteria */
enum { LARGEST_DIMENSION = 64 };

/* Robots that measure targets. Symmetric matrices are packed by rows of the lower triangle: entries = d (d + 1) / 2. */
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
EXPORTED double value_of(const Team *team, const double *sums);

/* Values of `width` matrices in the plane at once: sums (targets, entries, width), to each of which `offset` (targets,
   entries) is added; `product` (width) is spare. */
void planar_values(const Team *team, int width, const double *sums, const double *offset, double *values, double *product);

/* Fill `before` and `before_all` of a team whose other fields are set. */
EXPORTED void criteria_before(Team *team, double *before);
/* Values (1 << robots) of all sets, at most 16 robots; `sums` (robots + 1, targets, entries) is spare. */
EXPORTED void all_values(const Team *team, double *values, double *sums);
/* Which sources the library was compiled from. */
EXPORTED const char *sources(void);
/* Write for each set of robots of the blocks first..last - 1 its size plus one where it is worth less than the
   threshold, else 0; *next becomes the least value met that is not below, and *next_set its set. A set is worth no less
   than those inside it, so whole blocks are decided by their least and their largest set. Sets that no attack leaves
   are skipped as if they were not below: `outside` (blocks) has the fewest robots outside the block that must be blinded
   so that its sets are left of some group; `inside` (BLOCK + 1, 1 << BLOCK) those inside it, for each choice of all but
   the first b robots; together at most `most`. 1 where memory is short, else 0. */
EXPORTED int mark_below(const Team *team, double threshold, int64_t first, int64_t last, const uint8_t *outside, const uint8_t *inside,
                        int most, uint8_t *sizes, double *next, int64_t *next_set);
/* The level from which sets are not below a threshold, rounding included; infinite where no value is sure to be as high. */
EXPORTED double level_of_threshold(const Team *team, double threshold);
