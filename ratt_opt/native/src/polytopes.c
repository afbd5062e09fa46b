/* Outer polytopes of the information of sets in the plane, and the bound of an affine underestimator over their vertices. */
#include <math.h>
#include <string.h>

#include "polytopes.h"

enum { MOST_VERTICES = 512 };
enum { HALVINGS = 60 }; /* of a level's interval: to below the rounding of its ends */
static const double NEGLIGIBLE = 14.0; /* vertices that many temperatures above the least have no weight worth computing */

typedef struct {
    double at[MOST_VERTICES][3], slack[MOST_VERTICES];
    uint64_t facets[MOST_VERTICES];
    int count;
} Vertices;

/* Replace the vertices by those on or above the plane and those on it, which is facet `row`; 0 if there are too many or none.
   A new vertex lies on every segment between a kept and a lost vertex that share two facets. Segments that are not edges only
   add points of the polytope, which does no harm to an outer approximation. */
static int cut(Vertices *v, const double *normal, double offset, int row, int capacity) {
    double lost[MOST_VERTICES][4], least = INFINITY;
    uint64_t lost_facets[MOST_VERTICES];
    int kept = 0, gone = 0;
    for (int i = 0; i < v->count; i++) {
        v->slack[i] = v->at[i][0] * normal[0] + v->at[i][1] * normal[1] + v->at[i][2] * normal[2] - offset;
        least = fmin(least, v->slack[i]);
    }
    if (least >= 0) return 1;
    for (int i = 0; i < v->count; i++) {
        if (v->slack[i] >= 0) {
            v->slack[kept] = v->slack[i], v->facets[kept] = v->facets[i];
            memmove(v->at[kept++], v->at[i], sizeof(v->at[i]));
        } else {
            memcpy(lost[gone], v->at[i], sizeof(v->at[i]));
            lost[gone][3] = v->slack[i], lost_facets[gone++] = v->facets[i];
        }
    }
    v->count = kept;
    for (int i = 0; i < gone; i++)
        for (int q = 0; q < kept; q++) {
            uint64_t shared = lost_facets[i] & v->facets[q];
            if ((shared & (shared - 1)) == 0) continue;
            if (v->count >= capacity) return 0;
            double ratio = v->slack[q] / (v->slack[q] - lost[i][3]);
            for (int t = 0; t < 3; t++) v->at[v->count][t] = v->at[q][t] + ratio * (lost[i][t] - v->at[q][t]);
            v->facets[v->count++] = shared | (uint64_t)1 << row;
        }
    return v->count > 0;
}

int64_t cut_polytopes(int64_t targets, int64_t patterns, int64_t rows, int64_t capacity, const double *normals, const double *offsets,
                      const double *factors, double *vertices, uint64_t *facets, int64_t *numbers) {
    int64_t total = 0;
    Vertices v;
    for (int64_t j = 0; j < targets; j++)
        for (int64_t p = 0; p < patterns; p++) {
            const double *offset = offsets + (j * patterns + p) * rows, *factor = factors + 9 * j;
            v.count = 8;
            for (int i = 0; i < 8; i++) {
                v.facets[i] = 0;
                for (int t = 0; t < 3; t++) {
                    int high = i >> t & 1;
                    v.at[i][t] = high ? -offset[3 + t] : offset[t];
                    v.facets[i] |= (uint64_t)1 << (t + 3 * high);
                }
            }
            int fits = 1;
            for (int64_t row = 6; row < rows && fits; row++)
                fits = cut(&v, normals + 3 * (j * rows + row), offset[row], (int)row, (int)capacity);
            numbers[j * patterns + p] = fits ? v.count : 0;
            for (int i = 0; i < v.count && fits; i++, total++) {
                facets[total] = v.facets[i];
                for (int s = 0; s < 3; s++)
                    vertices[3 * total + s] = factor[3 * s] * v.at[i][0] + factor[3 * s + 1] * v.at[i][1] + factor[3 * s + 2] * v.at[i][2];
            }
        }
    return total;
}

/* One target's value, trace or log-det; minus infinity if the matrix is not positive definite. */
static double planar_value(const Team *team, int64_t j, double a, double b, double c) {
    const double *prior = team->prior + 3 * j;
    double determinant = a * c - b * b, before = prior[0] * prior[2] - prior[1] * prior[1];
    if (!(determinant > 1e-12 * (a + c) * (a + c) && a + c > 0)) return -INFINITY;
    if (team->criterion == TRACE) return team->weights[j] * ((prior[0] + prior[2]) / before - (a + c) / determinant);
    return team->weights[j] * log(determinant / before);
}

void vertex_values(const Team *team, int64_t patterns, const double *starts, const double *vertices, const int64_t *numbers,
                   double *values) {
    int64_t v = 0;
    for (int64_t k = 0; k < team->targets * patterns; k++)
        for (int64_t i = 0; i < numbers[k]; i++, v++)
            values[v] = planar_value(team, k / patterns, starts[3 * k] + vertices[3 * v], starts[3 * k + 1] + vertices[3 * v + 1],
                                     starts[3 * k + 2] + vertices[3 * v + 2]);
}

void rest_of_vertices(const Program *p, const double *multipliers, double *rest, double *spare) {
    for (int64_t j = 0; j < p->targets; j++) {
        const double *slope = multipliers + j * (3 + p->heavies), *own = slope + 3;
        for (int64_t q = 0; q < p->patterns; q++) {
            spare[q] = 0.0;
            for (int64_t h = 0; h < p->heavies; h++) spare[q] += p->inside[q * p->heavies + h] * own[h];
        }
        for (int64_t v = p->first[j]; v < p->first[j + 1]; v++) {
            const double *light = p->light + 3 * v;
            rest[v] = p->values[v] - (slope[0] * light[0] + slope[1] * light[1] + slope[2] * light[2]) - spare[p->pattern[v]];
        }
    }
}

/* One target's least `rest`, and the soft one, whose gradient (3 + heavies) is filled; `weight` (patterns) is spare. */
static double soft_least(const Program *p, int64_t j, const double *rest, double temperature, double *gradient, double *weight,
                         double *soft) {
    double least = INFINITY, mass = 0.0;
    for (int64_t v = p->first[j]; v < p->first[j + 1]; v++) least = fmin(least, rest[v]);
    memset(weight, 0, (size_t)p->patterns * sizeof(double));
    for (int64_t v = p->first[j]; v < p->first[j + 1]; v++) {
        if (!(rest[v] <= least + NEGLIGIBLE * temperature)) continue;
        double share = exp((least - rest[v]) / temperature);
        mass += share, weight[p->pattern[v]] += share;
        for (int t = 0; t < 3; t++) gradient[t] -= share * p->light[3 * v + t];
    }
    for (int64_t q = 0; q < p->patterns; q++)
        for (int64_t h = 0; h < p->heavies && weight[q] > 0; h++) gradient[3 + h] -= weight[q] * p->inside[q * p->heavies + h];
    for (int64_t t = 0; t < 3 + p->heavies; t++) gradient[t] /= mass;
    *soft = least - temperature * log(mass);
    return least;
}

/* The smoothed sum of the `size` least scores, by its dual: fractions 1 / (1 + exp((score - level) / temperature)) that add up to the
   size. */
static double soft_choice(const Program *p, const double *scores, double low, double high, double temperature, double *fraction) {
    low -= 40 * temperature, high += 40 * temperature;
    for (int step = 0; step < HALVINGS; step++) {
        double level = (low + high) / 2, count = 0.0;
        for (int64_t i = 0; i < p->robots; i++) count += 1 / (1 + exp((scores[i] - level) / temperature));
        if (count < (double)p->size) low = level;
        else high = level;
    }
    double level = (low + high) / 2, total = level * (double)p->size;
    for (int64_t i = 0; i < p->robots; i++) {
        double above = (level - scores[i]) / temperature;
        fraction[i] = 1 / (1 + exp(-above));
        total -= temperature * (fmax(above, 0.0) + log1p(exp(-fabs(above))));
    }
    return total;
}

double smoothed_bound(const Program *p, const double *multipliers, double temperature, double *gradient, double *fraction, double *soft,
                      double *rest, double *spare) {
    double bound = 0.0, total = 0.0, *scores = spare + p->patterns, *sorted = scores + p->robots;
    int64_t width = 3 + p->heavies;
    rest_of_vertices(p, multipliers, rest, spare);
    for (int64_t i = 0; i < p->robots; i++) {
        scores[i] = 0.0;
        for (int64_t j = 0; j < p->targets; j++)
            for (int t = 0; t < 3; t++) scores[i] += p->information[3 * (i * p->targets + j) + t] * multipliers[j * width + t];
    }
    for (int64_t j = 0; j < p->targets; j++) {
        double own;
        if (p->first[j] == p->first[j + 1]) continue;
        bound += soft_least(p, j, rest, temperature, gradient + j * width, spare, &own);
        total += own;
        for (int64_t h = 0; h < p->heavies; h++) scores[p->heavy[j * p->heavies + h]] += multipliers[j * width + 3 + h];
    }
    for (int64_t i = 0; i < p->robots; i++) {
        int64_t k = i;
        for (; k > 0 && sorted[k - 1] > scores[i]; k--) sorted[k] = sorted[k - 1];
        sorted[k] = scores[i];
    }
    for (int64_t i = 0; i < p->size; i++) bound += sorted[i];
    total += soft_choice(p, scores, sorted[0], sorted[p->robots - 1], temperature, fraction);
    for (int64_t j = 0; j < p->targets; j++) {
        for (int64_t i = 0; i < p->robots; i++)
            for (int t = 0; t < 3; t++) gradient[j * width + t] += fraction[i] * p->information[3 * (i * p->targets + j) + t];
        for (int64_t h = 0; h < p->heavies && p->first[j] < p->first[j + 1]; h++)
            gradient[j * width + 3 + h] += fraction[p->heavy[j * p->heavies + h]];
    }
    *soft = total;
    return bound;
}
