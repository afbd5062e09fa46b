/* Joins states of two parts of a network, each with some links cut, and keeps those that no other one is as good as.
 *
 * A state is a row: weight of the links cut, number of the state, sizes of its classes. Its classes become those of the
 * joined one by a map (-1: a class that nothing joins any more). A state is as good as another one if it cuts no more and
 * none of its classes is larger. */
#include <string.h>

#include "cut_states.h"

enum { CUT, FIRST, SECOND, SIZES };   /* of a joined state: two numbers, of the states joined */

/* Whether a state in the front is as good; drops those that the new one, the last row, is as good as. */
static int is_beaten(CutFront *f) {
    int64_t stride = SIZES + f->classes, kept = 0;
    const int64_t *fresh = f->states + f->count * stride;
    for (int64_t k = 0; k < f->count; k++) {
        const int64_t *old = f->states + k * stride;
        int is_better = old[CUT] <= fresh[CUT];
        for (int64_t c = SIZES; is_better && c < stride; c++) is_better = old[c] <= fresh[c];
        if (is_better) return 1;
    }
    for (int64_t k = 0; k < f->count; k++) {
        int64_t *old = f->states + k * stride;
        int is_worse = fresh[CUT] <= old[CUT];
        for (int64_t c = SIZES; is_worse && c < stride; c++) is_worse = fresh[c] <= old[c];
        if (is_worse) continue;
        if (kept != k) memcpy(f->states + kept * stride, old, sizeof(int64_t) * (size_t)stride);
        kept++;
    }
    if (kept != f->count) memcpy(f->states + kept * stride, fresh, sizeof(int64_t) * (size_t)stride);
    f->count = kept;
    return 0;
}

static void add_sizes(int64_t *sizes, const int64_t *own, const int64_t *map, int64_t classes) {
    for (int64_t c = 0; c < classes; c++)
        if (map[c] >= 0) sizes[map[c]] += own[c];
}

int64_t join_cut_states(CutFront *f, const CutStates *a, const CutStates *b, int64_t start, int64_t pairs) {
    int64_t k = start, stride = SIZES + f->classes;
    for (; k < a->count && pairs > 0 && f->count + b->count < f->capacity; k++, pairs -= b->count) {
        const int64_t *one = a->states + k * (2 + a->classes);
        for (int64_t j = 0; j < b->count; j++) {
            const int64_t *other = b->states + j * (2 + b->classes);
            int64_t *fresh = f->states + f->count * stride, fits = 1;
            if (one[0] + other[0] > f->most_cut) break;
            memset(fresh, 0, sizeof(int64_t) * (size_t)stride);
            fresh[CUT] = one[0] + other[0], fresh[FIRST] = one[1], fresh[SECOND] = other[1];
            add_sizes(fresh + SIZES, one + 2, a->map, a->classes);
            add_sizes(fresh + SIZES, other + 2, b->map, b->classes);
            for (int64_t c = 0; fits && c < f->classes; c++) fits = fresh[SIZES + c] <= f->room[c];
            if (fits && !is_beaten(f)) f->count++;
        }
    }
    return k;
}
