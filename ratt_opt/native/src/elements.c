/* What sets of elements tell, bounded in the Loewner order, and what groups of robots can gain. */
#include "elements.h"

#include <math.h>
#include <string.h>

double gained(const Elements *all, int64_t target, const double *matrix) {
    int d = all->dimension;
    double criterion = all->criterion == TRACE ? trace_of_inverse(d, matrix) : -log_determinant(d, matrix);
    return all->baseline[target] - all->weights[target] * criterion;
}

double gained_in_all(const Elements *all, const double *sums, double *values) {
    double total = 0.0;
    for (int64_t j = 0; j < all->targets; j++) {
        values[j] = gained(all, j, sums + j * all->entries);
        total += values[j];
    }
    return total;
}

static void raised_in_the_plane(const double *first, const double *second, double *out) {
    double a = second[0] - first[0], b = second[1] - first[1], c = second[2] - first[2];
    double middle = (a + c) / 2, half = sqrt((a - c) * (a - c) / 4 + b * b), share = 1.0, low = 0.0;
    if (middle > -half && middle < half) /* times the projector (X - low) / (high - low) */
        share = (middle + half) / (2 * half), low = middle - half;
    else if (middle < half) share = 0.0;
    out[0] = first[0] + share * (a - low);
    out[1] = first[1] + share * b;
    out[2] = first[2] + share * (c - low);
}

void raised(int d, const double *first, const double *second, double *out) {
    if (d == 2) {
        raised_in_the_plane(first, second, out);
        return;
    }
    double matrix[LARGEST_DIMENSION][LARGEST_DIMENSION], axes[LARGEST_DIMENSION][LARGEST_DIMENSION];
    for (int i = 0; i < d; i++)
        for (int j = 0; j <= i; j++) {
            int k = i * (i + 1) / 2 + j;
            matrix[i][j] = matrix[j][i] = second[k] - first[k];
            axes[i][j] = axes[j][i] = i == j ? 1.0 : 0.0;
        }
    diagonalise(d, matrix, axes);
    for (int i = 0; i < d; i++)
        for (int j = 0; j <= i; j++) {
            double more = 0.0;
            for (int m = 0; m < d; m++) more += (matrix[m][m] > 0.0 ? matrix[m][m] : 0.0) * axes[i][m] * axes[j][m];
            out[i * (i + 1) / 2 + j] = first[i * (i + 1) / 2 + j] + more;
        }
}

void bound_robot(const Choices *choices, int64_t robot, uint64_t mask, double *bound) {
    const Elements *all = &choices->all;
    memset(bound, 0, (size_t)width_of(all) * sizeof(double));
    for (; mask; mask &= mask - 1) {
        int64_t e = choices->element[robot * choices->widest + lowest(mask)];
        for (int64_t j = 0; j < all->targets; j++) {
            double *own = bound + j * all->entries;
            if (sees(all, e, j)) raised(all->dimension, own, information_of(all, e, j), own);
        }
    }
}

void bound_robots(const Choices *choices, const uint64_t *masks, double *bounds) {
    for (int64_t i = 0; i < choices->robots; i++) bound_robot(choices, i, masks[i], bounds + i * width_of(&choices->all));
}

void group_values(const Choices *choices, const double *bounds, int64_t groups, const uint8_t *members, double *values) {
    const Elements *all = &choices->all;
    double matrix[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2];
    for (int64_t g = 0; g < groups; g++)
        for (int64_t j = 0; j < all->targets; j++) {
            for (int64_t k = 0; k < all->entries; k++) {
                matrix[k] = all->prior[j * all->entries + k];
                for (int64_t i = 0; i < choices->robots; i++)
                    if (members[g * choices->robots + i]) matrix[k] += bounds[i * width_of(all) + j * all->entries + k];
            }
            values[g * all->targets + j] = gained(all, j, matrix);
        }
}
