/* Attacks on all plans of a frame at once: a frame that one attack ends is a dead end by a new cover, which then keeps
   as many elements more as it can, those first that were forbidden last. */
#include <math.h>
#include <string.h>

#include "covers.h"

static void add(int64_t width, const double *matrices, double sign, double *sums) {
    for (int64_t t = 0; t < width; t++) sums[t] += sign * matrices[t];
}

/* Whether packed matrices tell about a target: no diagonal of information is zero otherwise. */
static int tells(const Elements *all, const double *matrices, int64_t target) {
    return matrices[target * all->entries] != 0.0 || matrices[(target + 1) * all->entries - 1] != 0.0;
}

/* What is left of a group if one more robot is blinded, which tells `less`, in exchange for one that senses again and
   tells `back` (NULL: none). */
static double left_after(const Elements *all, const double *back, const double *less, const Scratch *scratch) {
    double total = 0.0, matrix[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2];
    for (int64_t j = 0; j < all->targets; j++) {
        if (!tells(all, less, j) && !(back && tells(all, back, j))) {
            total += scratch->values[j];
            continue;
        }
        for (int64_t k = 0; k < all->entries; k++) {
            int64_t t = j * all->entries + k;
            matrix[k] = scratch->sums[t] - less[t];
            if (back) matrix[k] += back[t];
        }
        total += gained(all, j, matrix);
    }
    return total;
}

/* Whether a robot of a group may be blinded and is not yet. */
static int is_open(const Choices *choices, const uint8_t *members, const uint8_t *blinded, int64_t robot) {
    return members[robot] && !blinded[robot] && !choices->safe[robot];
}

/* Exchange a blinded robot for another as often as that lowers what is left of a group, until it is at most the level;
   what is left then. */
static double exchange(const Choices *choices, const double *strongest, const uint8_t *members, double level, double worth,
                       uint8_t *blinded, Scratch *scratch) {
    int64_t robots = choices->robots, width = width_of(&choices->all);
    int improved = 1;
    while (worth > level && improved) {
        improved = 0;
        for (int64_t a = 0; a < robots; a++)
            for (int64_t b = 0; b < robots; b++) {
                if (!blinded[a] || !is_open(choices, members, blinded, b)) continue;
                double left = left_after(&choices->all, strongest + a * width, strongest + b * width, scratch);
                if (!(left < worth - fmax(choices->all.relative * fabs(worth), choices->all.rounding))) continue;
                add(width, strongest + a * width, 1.0, scratch->sums);
                add(width, strongest + b * width, -1.0, scratch->sums);
                blinded[a] = 0, blinded[b] = 1, improved = 1;
                worth = gained_in_all(&choices->all, scratch->sums, scratch->values);
            }
    }
    return worth;
}

/* How many robots of a group to blind until it is worth at most the level: greedily, then by exchanges. More than `most`
   if that is not enough. `blinded` (robots) is set to these. */
static int64_t blind(const Choices *choices, const double *strongest, const uint8_t *members, double level, int64_t most, uint8_t *blinded,
                     Scratch *scratch) {
    const Elements *all = &choices->all;
    int64_t robots = choices->robots, width = width_of(all), count = 0;
    memset(blinded, 0, (size_t)robots);
    memcpy(scratch->sums, all->prior, (size_t)width * sizeof(double));
    for (int64_t i = 0; i < robots; i++)
        if (members[i]) add(width, strongest + i * width, 1.0, scratch->sums);
    double worth = gained_in_all(all, scratch->sums, scratch->values);
    while (worth > level && count < most) {
        int64_t best = -1;
        double lowest = INFINITY;
        for (int64_t i = 0; i < robots; i++) {
            if (!is_open(choices, members, blinded, i)) continue;
            double left = left_after(all, NULL, strongest + i * width, scratch);
            if (left < lowest) best = i, lowest = left;
        }
        if (best < 0) return most + 1;
        blinded[best] = 1;
        add(width, strongest + best * width, -1.0, scratch->sums);
        worth = gained_in_all(all, scratch->sums, scratch->values);
        count++;
    }
    if (count == most && most > 0) worth = exchange(choices, strongest, members, level, worth, blinded, scratch);
    return worth <= level ? count : most + 1;
}

/* Add the cover of an attack: of each group that its partition leaves it keeps what may be chosen and is not blinded,
   and as much more as the level allows; what was forbidden last has the highest price. */
static int64_t keep_more(const Choices *choices, const Ways *ways, Covers *covers, const Stack *stack, double level, int64_t partition,
                         Scratch *scratch) {
    int64_t elements = choices->all.elements, robots = choices->robots, number = covers->size++;
    const uint64_t *allowed = stack->allowed + stack->frame * robots;
    uint64_t *left_out = covers->left_out + number * robots;
    covers->partition[number] = partition, covers->level[number] = level;
    memset(left_out, 0, (size_t)robots * sizeof(uint64_t));
    for (int64_t e = 0; e < elements; e++) {
        scratch->may[e] = allowed[choices->owner[e]] >> choices->place[e] & 1;
        scratch->price[e] = (double)(scratch->may[e] ? stack->frame : stack->since[e]) + 2.0;
    }
    for (int64_t place = 0; place < ways->widest; place++) {
        int64_t g = ways->of[partition * ways->widest + place];
        if (g < 0) break;
        const uint8_t *inside = ways->inside + g * elements, *blinded = scratch->blinded + g * robots;
        double *sums = covers->sums + (number * covers->groups + place) * width_of(&choices->all);
        for (int64_t e = 0; e < elements; e++) scratch->kept[e] = scratch->may[e] && inside[e] && !blinded[choices->owner[e]];
        keep(choices, inside, scratch->price, level, scratch->kept, sums, scratch);
        for (int64_t e = 0; e < elements; e++)
            if (inside[e] && !scratch->kept[e]) left_out[choices->owner[e]] |= (uint64_t)1 << choices->place[e];
    }
    return number;
}

int64_t new_cover(const Choices *choices, const Ways *ways, Covers *covers, const Stack *stack, double level, int64_t most,
                  Scratch *scratch) {
    int64_t alpha = (int64_t)choices->enough - 1, robots = choices->robots;
    const double *strongest = stack->strongest + stack->frame * robots * width_of(&choices->all);
    for (int64_t g = 0; g < ways->groups; g++) scratch->needs[g] = -1;
    for (int64_t tried = 0; tried < ways->partitions && tried < most; tried++) {
        int64_t p = ways->order[tried], need = 0;
        const int64_t *of = ways->of + p * ways->widest;
        for (int64_t place = 0; place < ways->widest && of[place] >= 0 && need <= alpha; place++) {
            int64_t g = of[place];
            uint8_t *blinded = scratch->blinded + g * robots;
            if (scratch->needs[g] < 0)
                scratch->needs[g] = blind(choices, strongest, ways->members + g * robots, level, alpha, blinded, scratch);
            need += scratch->needs[g];
        }
        if (need > alpha) continue;
        for (int64_t q = tried; q > 0; q--) ways->order[q] = ways->order[q - 1];
        ways->order[0] = p;
        return keep_more(choices, ways, covers, stack, level, p, scratch);
    }
    return -1;
}
