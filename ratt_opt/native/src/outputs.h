/* Covariances of outputs. */
#pragma once
#include "sets.h"

/* Covariances (count, targets, q, q); matrices (count, targets, d, d), output (targets, q, d), `spare` (d + q, d). */
EXPORTED void output_covariances(int64_t count, int64_t targets, int64_t q, int64_t d, const double *matrices, const double *output,
                                 double *spare, double *covariances);
