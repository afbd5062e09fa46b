/* Elements that an attack can afford to leave.

   The robots of one group may choose among kept elements only. What such a choice tells about a target is, in the
   Loewner order, at most the prior's information plus, robot by robot, an upper bound (`raised`) of the matrices of its
   kept elements. The values of these sums bound what the group is worth.

   Targets are lost first: nothing is kept that sees them, until the others are worth no more than the level. Then
   elements come back one by one, as long as the level is not exceeded. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "covers.h"

/* Added to every price: among free elements those that cost least of the level come first. */
static const double NO_PRICE = 1e-3;

int prepare_scratch(Scratch *scratch, const Choices *choices, int64_t groups) {
    int64_t robots = choices->robots, elements = choices->all.elements, targets = choices->all.targets;
    int64_t width = width_of(&choices->all);
    int64_t cells = (robots + 2) * width + 2 * targets + 2 * elements + 3 * robots + groups, bytes = groups * robots + 2 * elements;
    double *next = scratch->memory = calloc((size_t)(8 * cells + bytes + 1), 1);
    if (!next) return 1;
    scratch->sums = next, next += width;
    scratch->more = next, next += width;
    scratch->bound = next, next += robots * width;
    scratch->values = next, next += targets;
    scratch->after = next, next += targets;
    scratch->order = next, next += elements;
    scratch->price = next, next += elements;
    scratch->most = next, next += robots;
    scratch->rises = next, next += robots;
    scratch->conflict = (uint64_t *)next, next += robots;
    scratch->needs = (int64_t *)next, next += groups;
    scratch->blinded = (uint8_t *)next;
    scratch->may = scratch->blinded + groups * robots, scratch->kept = scratch->may + elements;
    return 0;
}

/* Lose targets of a group until the rest is worth at most `level`; the price of all elements that see a lost one.
   `out` (elements): the group's elements that see no lost target. `costs`, `lost` (targets). */
static double lose(const Elements *all, const uint8_t *inside, const double *price, const double *values, double level, const double *noise,
                   uint8_t *out, double *costs, uint8_t *lost) {
    double left = 0.0, paid = 0.0;
    for (int64_t j = 0; j < all->targets; j++) left += values[j], costs[j] = 0.0, lost[j] = 0;
    for (int64_t e = 0; e < all->elements; e++) {
        out[e] = inside[e];
        for (int64_t j = 0; j < all->targets; j++)
            if (out[e] && sees(all, e, j)) costs[j] += price[e];
    }
    while (left > level) {
        int64_t best = -1;
        double most = -1.0;
        for (int64_t j = 0; j < all->targets; j++) {
            if (lost[j] || !(values[j] > 0)) continue;
            double gain = fmin(values[j], left - level) / (fmax(costs[j], 0.0) + NO_PRICE) * noise[j];
            if (gain > most) best = j, most = gain;
        }
        if (best < 0) return INFINITY;
        lost[best] = 1;
        left -= values[best];
        for (int64_t e = 0; e < all->elements; e++) {
            if (!out[e] || !sees(all, e, best)) continue;
            out[e] = 0;
            paid += price[e];
            for (int64_t j = 0; j < all->targets; j++)
                if (sees(all, e, j)) costs[j] -= price[e];
        }
    }
    return paid;
}

int lose_all(const Choices *choices, int64_t groups, const uint8_t *inside, const double *price, const double *values, double level,
             const double *noise, uint8_t *out, double *paid) {
    const Elements *all = &choices->all;
    int64_t elements = all->elements, targets = all->targets;
    double *costs = calloc((size_t)targets + 1, sizeof(double));
    uint8_t *lost = calloc((size_t)targets + 1, 1);
    int is_short = !costs || !lost;
    for (int64_t g = 0; g < groups && !is_short; g++) {
        int64_t e = g * elements, j = g * targets;
        paid[g] = lose(all, inside + e, price, values + j, level, noise + j, out + e, costs, lost);
    }
    free(costs);
    free(lost);
    return is_short;
}

/* Set the bounds of what kept elements tell, `sums` to what all tell with the prior, and the targets' values. */
static void bound_kept(const Choices *choices, const uint8_t *kept, double *sums, Scratch *scratch) {
    const Elements *all = &choices->all;
    int64_t width = width_of(all);
    memset(scratch->bound, 0, (size_t)(choices->robots * width) * sizeof(double));
    for (int64_t e = 0; e < all->elements; e++)
        for (int64_t j = 0; j < all->targets; j++) {
            double *own = scratch->bound + choices->owner[e] * width + j * all->entries;
            if (kept[e] && sees(all, e, j)) raised(all->dimension, own, information_of(all, e, j), own);
        }
    for (int64_t t = 0; t < width; t++) {
        sums[t] = all->prior[t];
        for (int64_t i = 0; i < choices->robots; i++) sums[t] += scratch->bound[i * width + t];
    }
    for (int64_t j = 0; j < all->targets; j++) scratch->values[j] = gained(all, j, sums + j * all->entries);
}

/* How much the bound rises with one more element; `more` and `after` are set to its robot's bounds and the values then. */
static double rise_with(const Choices *choices, int64_t e, const double *sums, Scratch *scratch) {
    const Elements *all = &choices->all;
    const double *own = scratch->bound + choices->owner[e] * width_of(all);
    double rise = 0.0, matrix[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2];
    for (int64_t j = 0; j < all->targets; j++) {
        if (!sees(all, e, j)) continue;
        double *more = scratch->more + j * all->entries;
        raised(all->dimension, own + j * all->entries, information_of(all, e, j), more);
        for (int64_t k = 0; k < all->entries; k++) matrix[k] = sums[j * all->entries + k] + more[k] - own[j * all->entries + k];
        scratch->after[j] = gained(all, j, matrix);
        rise += scratch->after[j] - scratch->values[j];
    }
    return rise;
}

/* Add the element that `rise_with` looked at. */
static void take(const Choices *choices, int64_t e, double *sums, Scratch *scratch) {
    const Elements *all = &choices->all;
    double *own = scratch->bound + choices->owner[e] * width_of(all);
    for (int64_t j = 0; j < all->targets; j++) {
        if (!sees(all, e, j)) continue;
        scratch->values[j] = scratch->after[j];
        for (int64_t t = j * all->entries; t < (j + 1) * all->entries; t++) {
            sums[t] += scratch->more[t] - own[t];
            own[t] = scratch->more[t];
        }
    }
}

static int64_t least_of(const double *order, int64_t count) {
    int64_t best = 0;
    for (int64_t e = 1; e < count; e++)
        if (order[e] < order[best]) best = e;
    return best;
}

double keep(const Choices *choices, const uint8_t *inside, const double *price, double level, uint8_t *kept, double *sums,
            Scratch *scratch) {
    int64_t elements = choices->all.elements;
    double worth = 0.0, paid = 0.0, *order = scratch->order;
    bound_kept(choices, kept, sums, scratch);
    for (int64_t j = 0; j < choices->all.targets; j++) worth += scratch->values[j];
    for (int64_t e = 0; e < elements; e++) {
        order[e] = INFINITY;
        if (inside[e] && !kept[e]) order[e] = (fmax(rise_with(choices, e, sums, scratch), 0.0) + 1e-9) / (price[e] + NO_PRICE);
    }
    for (int64_t n = 0; n < elements; n++) {
        int64_t e = least_of(order, elements);
        if (order[e] == INFINITY) break;
        order[e] = INFINITY;
        double rise = rise_with(choices, e, sums, scratch);
        if (worth + rise > level) {
            paid += price[e];
            continue;
        }
        kept[e] = 1;
        worth += rise;
        take(choices, e, sums, scratch);
    }
    return paid;
}

int keep_elements(const Choices *choices, const uint8_t *inside, const double *price, double level, uint8_t *kept, double *sums,
                  double *paid) {
    Scratch scratch;
    if (prepare_scratch(&scratch, choices, 0)) return 1;
    *paid = keep(choices, inside, price, level, kept, sums, &scratch);
    free(scratch.memory);
    return 0;
}
