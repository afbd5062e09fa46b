/* Values of posterior information matrices. */
#include "team.h"

#include <math.h>
#include <string.h>

static const double NEGLIGIBLE = 1e-18; /* beside the diagonal: less than rounding of the eigenvalues */

enum { SWEEPS = 10 };  /* of rotations: what is left then beside the diagonal is rounding */
enum { PRODUCTS = 8 }; /* ratios of determinants below one logarithm: each is below 1e31, see information.py, WIDEST */

int entries_of(const Team *team) { return team->dimension * (team->dimension + 1) / 2; }

double least_improvement(const Team *team, double value) { return fmax(team->relative * fabs(value), team->rounding); }

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

static double planar_criterion(int criterion, const double *matrix) {
    double a = matrix[0], b = matrix[1], c = matrix[2], determinant = a * c - b * b;
    if (criterion == LOG_DET) return determinant;
    if (criterion == TRACE) return (a + c) / determinant;
    double half = (a - c) / 2;
    return ((a + c) / 2 + sqrt(half * half + b * b)) / determinant;
}

/* Column j of L^-1, L a factor, from the diagonal on. */
static void invert(int d, const double *factor, int j, double *column) {
    for (int i = j; i < d; i++) {
        const double *row = factor + i * (i + 1) / 2;
        double rest = i == j ? 1.0 : 0.0;
        for (int k = j; k < i; k++) rest -= row[k] * column[k];
        column[i] = rest / row[i];
    }
}

/* The sum of squares of the entries of L^-1, column by column. */
double trace_of_inverse(int d, const double *matrix) {
    if (d == 2) return planar_criterion(TRACE, matrix);
    double total = 0.0, factor[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2], column[LARGEST_DIMENSION];
    factorise(d, matrix, factor);
    for (int j = 0; j < d; j++) {
        invert(d, factor, j, column);
        for (int i = j; i < d; i++) total += column[i] * column[i];
    }
    return total;
}

double log_determinant(int d, const double *matrix) {
    if (d == 2) return log(planar_criterion(LOG_DET, matrix));
    double total = 0.0, factor[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2];
    factorise(d, matrix, factor);
    for (int i = 0; i < d; i++) total += 2.0 * log(factor[i * (i + 3) / 2]);
    return total;
}

static void turn(double *x, double *y, double cosine, double sine) {
    double was = *x;
    *x = cosine * was - sine * *y;
    *y = sine * was + cosine * *y;
}

/* Jacobi's rotation: the entry (p, q) becomes 0. */
static void rotate(int d, double matrix[][LARGEST_DIMENSION], double axes[][LARGEST_DIMENSION], int p, int q) {
    if (matrix[p][q] == 0.0) return;
    double angle = 0.5 * atan2(2.0 * matrix[p][q], matrix[q][q] - matrix[p][p]), cosine = cos(angle), sine = sin(angle);
    for (int k = 0; k < d; k++) turn(&matrix[k][p], &matrix[k][q], cosine, sine);
    for (int k = 0; k < d; k++) turn(&matrix[p][k], &matrix[q][k], cosine, sine);
    for (int k = 0; k < d && axes; k++) turn(&axes[k][p], &axes[k][q], cosine, sine);
}

void diagonalise(int d, double matrix[][LARGEST_DIMENSION], double axes[][LARGEST_DIMENSION]) {
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double beside = 0.0, diagonal = 0.0;
        for (int p = 0; p < d; p++) {
            diagonal += fabs(matrix[p][p]);
            for (int q = p + 1; q < d; q++) beside += fabs(matrix[p][q]);
        }
        if (beside <= NEGLIGIBLE * diagonal) return;
        for (int p = 0; p < d - 1; p++)
            for (int q = p + 1; q < d; q++) rotate(d, matrix, axes, p, q);
    }
}

/* The largest eigenvalue of the inverse, L^-T L^-1. */
static double largest_of_inverse(int d, const double *packed) {
    double factor[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2];
    double columns[LARGEST_DIMENSION][LARGEST_DIMENSION], matrix[LARGEST_DIMENSION][LARGEST_DIMENSION]; /* not cleared: 64 kB */
    factorise(d, packed, factor);
    for (int j = 0; j < d; j++) invert(d, factor, j, columns[j]);
    for (int i = 0; i < d; i++)
        for (int j = 0; j < d; j++) {
            matrix[i][j] = 0.0;
            for (int k = i > j ? i : j; k < d; k++) matrix[i][j] += columns[i][k] * columns[j][k];
        }
    diagonalise(d, matrix, NULL);
    double largest = matrix[0][0];
    for (int i = 1; i < d; i++) largest = fmax(largest, matrix[i][i]);
    return largest;
}

static double any_criterion(const Team *team, const double *matrix) {
    int d = team->dimension;
    if (d == 2) return planar_criterion(team->criterion, matrix);
    if (team->criterion == TRACE) return trace_of_inverse(d, matrix);
    if (team->criterion == LOG_DET) return log_determinant(d, matrix);
    return largest_of_inverse(d, matrix);
}

/* The larger of `largest` and a target's weighted eigenvalue, which is no larger than the trace. */
static double larger(const Team *team, int j, const double *matrix, double largest) {
    if (team->dimension != 2 && team->weights[j] * trace_of_inverse(team->dimension, matrix) <= largest) return largest;
    return fmax(largest, team->weights[j] * any_criterion(team, matrix));
}

void criteria_before(Team *team, double *before) {
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
        if (team->criterion == LARGEST) {
            total = larger(team, j, sums + j * entries, total);
            continue;
        }
        double now = any_criterion(team, sums + j * entries), weight = team->weights[j];
        if (team->criterion == TRACE) {
            total += weight * (team->before[j] - now);
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

void planar_values(const Team *team, int width, const double *sums, const double *offset, double *values, double *product) {
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

void all_values(const Team *team, double *values, double *sums) {
    int width = team->targets * entries_of(team);
    memcpy(sums, team->prior, (size_t)width * sizeof(double));
    for (int64_t set = 0; set < (int64_t)1 << team->robots; set++) {
        /* Sets come as numbers: what changed are the low robots; depth counts the robots above them. */
        int depth = set ? size_of((uint64_t)set) : 0;
        if (set) add_information(team, sums + (depth - 1) * width, 1.0, lowest((uint64_t)set), sums + depth * width);
        values[set] = value_of(team, sums + depth * width);
    }
}

#ifndef SOURCES
#define SOURCES "unknown"
#endif

const char *sources(void) { return SOURCES; }
