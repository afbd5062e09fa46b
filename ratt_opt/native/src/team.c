/* Values of posterior information matrices. */
#include "team.h"

#include <math.h>
#include <stddef.h>

#include "sets.h"

enum { PRODUCTS = 8 }; /* ratios of determinants below one logarithm: each is below 1e31, see information.py, WIDEST */

int entries_of(const Team *team) { return team->dimension * (team->dimension + 1) / 2; }

/* Cholesky factor L of a packed matrix, packed alike. */
static void factorise(int d, const double *matrix, double *factor) {
    for (int i = 0; i < d; i++)
        for (int j = 0; j <= i; j++) {
            const double *row = factor + i * (i + 1) / 2, *other = factor + j * (j + 1) / 2;
            double rest = matrix[i * (i + 1) / 2 + j];
            for (int k = 0; k < j; k++) rest -= row[k] * other[k];
            factor[i * (i + 1) / 2 + j] = i == j ? sqrt(rest) : rest / other[j];
        }
}

/* The trace of the inverse: the sum of squares of the entries of L^-1, column by column. */
static double trace_of_inverse(int d, const double *factor) {
    double total = 0.0, column[LARGEST_DIMENSION];
    for (int j = 0; j < d; j++)
        for (int i = j; i < d; i++) {
            const double *row = factor + i * (i + 1) / 2;
            double rest = i == j ? 1.0 : 0.0;
            for (int k = j; k < i; k++) rest -= row[k] * column[k];
            column[i] = rest / row[i];
            total += column[i] * column[i];
        }
    return total;
}

static double log_determinant(int d, const double *factor) {
    double total = 0.0;
    for (int i = 0; i < d; i++) total += 2.0 * log(factor[i * (i + 3) / 2]);
    return total;
}

static double planar_criterion(int criterion, const double *matrix) {
    double a = matrix[0], b = matrix[1], c = matrix[2], determinant = a * c - b * b;
    if (criterion == LOG_DET) return determinant;
    if (criterion == TRACE) return (a + c) / determinant;
    double half = (a - c) / 2;
    return ((a + c) / 2 + sqrt(half * half + b * b)) / determinant;
}

static double any_criterion(const Team *team, const double *matrix) {
    if (team->dimension == 2) return planar_criterion(team->criterion, matrix);
    double factor[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2];
    factorise(team->dimension, matrix, factor);
    return team->criterion == TRACE ? trace_of_inverse(team->dimension, factor) : log_determinant(team->dimension, factor);
}

/* Fill `before` and `before_all` of a team whose other fields are set. */
EXPORTED void criteria_before(Team *team, double *before) {
    team->before = before;
    team->before_all = 0.0;
    for (int j = 0; j < team->targets; j++) {
        before[j] = any_criterion(team, team->prior + (ptrdiff_t)j * entries_of(team));
        team->before_all = fmax(team->before_all, team->weights[j] * before[j]);
    }
}

/* Whether the product of ratios of determinants ends with target j. */
static int ends_product(const Team *team, int j) {
    return j % PRODUCTS == PRODUCTS - 1 || j == team->targets - 1 || team->weights[j + 1] != team->weights[j];
}

double value_of(const Team *team, const double *sums) {
    int entries = entries_of(team);
    double total = 0.0, product = 1.0;
    for (int j = 0; j < team->targets; j++) {
        double now = any_criterion(team, sums + j * entries), weight = team->weights[j];
        if (team->criterion == TRACE) {
            total += weight * (team->before[j] - now);
        } else if (team->criterion == LARGEST) {
            total = fmax(total, weight * now);
        } else if (team->dimension != 2) {
            total += weight * (now - team->before[j]);
        } else {
            product *= now / team->before[j];
            if (ends_product(team, j)) {
                total += weight * log(product);
                product = 1.0;
            }
        }
    }
    return team->criterion == LARGEST ? team->before_all - total : total;
}

static void planar_values(const Team *team, int width, const double *sums, const double *offset, double *values, double *product) {
    for (int k = 0; k < width; k++) values[k] = 0.0, product[k] = 1.0;
    for (int j = 0; j < team->targets; j++) {
        const double *first = sums + (ptrdiff_t)3 * j * width, *second = first + width, *third = second + width;
        double x = offset[3 * j], y = offset[3 * j + 1], z = offset[3 * j + 2];
        double weight = team->weights[j], before = team->before[j];
        if (team->criterion == TRACE) {
            for (int k = 0; k < width; k++) {
                double a = first[k] + x, b = second[k] + y, c = third[k] + z;
                values[k] += weight * (before - (a + c) / (a * c - b * b));
            }
        } else if (team->criterion == LARGEST) {
            for (int k = 0; k < width; k++) {
                double a = first[k] + x, b = second[k] + y, c = third[k] + z, half = (a - c) / 2;
                double now = weight * (((a + c) / 2 + sqrt(half * half + b * b)) / (a * c - b * b));
                values[k] = now > values[k] ? now : values[k];
            }
        } else {
            for (int k = 0; k < width; k++) {
                double a = first[k] + x, b = second[k] + y, c = third[k] + z;
                product[k] *= (a * c - b * b) / before;
            }
            if (ends_product(team, j))
                for (int k = 0; k < width; k++) values[k] += weight * log(product[k]), product[k] = 1.0;
        }
    }
    if (team->criterion == LARGEST)
        for (int k = 0; k < width; k++) values[k] = team->before_all - values[k];
}

void values_of(const Team *team, int width, const double *sums, const double *offset, double *values, double *spare) {
    if (team->dimension == 2) {
        planar_values(team, width, sums, offset, values, spare);
        return;
    }
    int entries = entries_of(team);
    for (int k = 0; k < width; k++) {
        values[k] = 0.0;
        for (int j = 0; j < team->targets; j++) {
            double matrix[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2];
            for (int t = 0; t < entries; t++) matrix[t] = sums[((ptrdiff_t)j * entries + t) * width + k] + offset[j * entries + t];
            double gained = team->weights[j] * (any_criterion(team, matrix) - team->before[j]);
            values[k] += team->criterion == TRACE ? -gained : gained;
        }
    }
}

#ifndef SOURCES
#define SOURCES "unknown"
#endif

/* Which sources the library was compiled from. */
EXPORTED const char *sources(void) { return SOURCES; }
