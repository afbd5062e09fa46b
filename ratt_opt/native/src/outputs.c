/* Covariances C L^-1 C' of outputs C (outputs, dimension) of states whose information L is positive definite. */
#include <math.h>

#include "outputs.h"

/* Compiled for each usual dimension: loops over as few entries take longer than what is in them. */
#define FOR_DIMENSION __attribute__((always_inline)) static inline

/* Cholesky factor of a matrix (d, d), below the diagonal. */
FOR_DIMENSION void factorise(int64_t d, const double *matrix, double *factor) {
    for (int64_t a = 0; a < d; a++)
        for (int64_t b = 0; b <= a; b++) {
            double left = matrix[a * d + b];
            for (int64_t c = 0; c < b; c++) left -= factor[a * d + c] * factor[b * d + c];
            factor[a * d + b] = a == b ? sqrt(left) : left / factor[b * d + b];
        }
}

/* solved = G^-1 row, G the factor. */
FOR_DIMENSION void solve(int64_t d, const double *factor, const double *row, double *solved) {
    for (int64_t a = 0; a < d; a++) {
        double left = row[a];
        for (int64_t c = 0; c < a; c++) left -= factor[a * d + c] * solved[c];
        solved[a] = left / factor[a * d + a];
    }
}

FOR_DIMENSION double product(int64_t d, const double *first, const double *second) {
    double total = 0.0;
    for (int64_t a = 0; a < d; a++) total += first[a] * second[a];
    return total;
}

/* With L = G G': the inner products of the columns of G^-1 C'. */
FOR_DIMENSION void covariances_of(int64_t count, int64_t targets, int64_t q, int64_t d, const double *matrices, const double *output,
                                  double *spare, double *covariances) {
    double *factor = spare, *solved = spare + d * d;
    for (int64_t k = 0; k < count * targets; k++) {
        const double *rows = output + k % targets * q * d;
        double *found = covariances + k * q * q;
        factorise(d, matrices + k * d * d, factor);
        for (int64_t row = 0; row < q; row++) {
            solve(d, factor, rows + row * d, solved + row * d);
            for (int64_t other = 0; other <= row; other++)
                found[row * q + other] = found[other * q + row] = product(d, solved + row * d, solved + other * d);
        }
    }
}

void output_covariances(int64_t count, int64_t targets, int64_t q, int64_t d, const double *matrices, const double *output, double *spare,
                        double *covariances) {
    if (d == 2) covariances_of(count, targets, q, 2, matrices, output, spare, covariances);
    else if (d == 4) covariances_of(count, targets, q, 4, matrices, output, spare, covariances);
    else if (d == 6) covariances_of(count, targets, q, 6, matrices, output, spare, covariances);
    else covariances_of(count, targets, q, d, matrices, output, spare, covariances);
}
