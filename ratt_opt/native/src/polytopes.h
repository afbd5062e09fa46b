/* Outer polytopes of the information of sets in the plane, and underestimators over their vertices. */
#pragma once
#include "team.h"

/* Parts of an affine underestimator: vertices of each target's polytopes, `light` (V, 3) with the value and the pattern of heavy
   robots of each; `multipliers` (targets, 3 + heavy): slopes, scores of the heavy robots. */
typedef struct {
    int64_t targets, robots, heavies, patterns, size;
    const int64_t *first, *pattern; /* (targets + 1), (V) */
    const double *values, *light;
    const double *inside;           /* (patterns, heavies) 1 if the heavy robot is in the pattern */
    const int64_t *heavy;           /* (targets, heavies) */
    const double *information;      /* (robots, targets, 3), zero for heavy robots */
} Program;

/* Vertices of many polytopes in three dimensions, one after the other; their number. Polytope (j, p) is {factors[j] y : normals[j] y >=
   offsets[j, p]}; its first six rows are the axes and their negatives, a box. Each further row cuts the vertices found so far.
   normals (targets, rows, 3), at most 64 rows; offsets (targets, patterns, rows); factors (targets, 3, 3). `vertices`, `facets`:
   room for `capacity` <= 512 each; numbers (targets, patterns), 0 if the capacity did not suffice. */
EXPORTED int64_t cut_polytopes(int64_t targets, int64_t patterns, int64_t rows, int64_t capacity, const double *normals,
                               const double *offsets, const double *factors, double *vertices, uint64_t *facets, int64_t *numbers);
/* Each target's value of the information starts (targets, patterns, 3) plus each vertex of polytope (j, p). */
EXPORTED void vertex_values(const Team *team, int64_t patterns, const double *starts, const double *vertices, const int64_t *numbers,
                            double *values);
/* `rest` (V): the value of each vertex less what the multipliers say; `spare` (patterns). */
EXPORTED void rest_of_vertices(const Program *p, const double *multipliers, double *rest, double *spare);
/* The bound of the multipliers, and its smoothed value in *soft; fills `gradient` (targets, 3 + heavies), zero before, and
   `fraction` (robots). `rest` (V), `spare` (patterns + 2 robots). */
EXPORTED double smoothed_bound(const Program *p, const double *multipliers, double temperature, double *gradient, double *fraction,
                               double *soft, double *rest, double *spare);
