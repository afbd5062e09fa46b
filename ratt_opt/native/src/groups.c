/* Columns of the master: the groups that an attack may leave, what each costs, and those that duals would buy. */
#include "records.h"
#include "sets.h"

/* The robot next to those inside, and not decided, with the most links to decided ones; -1 where there is none. Adds to *cut the
   links that such robots cost at least, each those to robots inside or those to robots outside. */
static int most_linked(const uint64_t *neighbours, const Branch *node, int64_t *cut) {
    int pick = -1, most = -1;
    for (uint64_t rest = node->near & ~(node->inside | node->outside); rest; rest &= rest - 1) {
        int i = lowest(rest), inside = size_of(neighbours[i] & node->inside), outside = size_of(neighbours[i] & node->outside);
        *cut += inside < outside ? inside : outside;
        if (inside + outside > most) pick = i, most = inside + outside;
    }
    return pick;
}

/* List connected sets that at most `most` links leave, none of them protected; each grows from its lowest robot, and a
   robot next to it is taken in or left out, which costs its links. At most 63 robots. Goes on from `position`: robots begun
   with, depth of the stack (2 robots + 2). Ends after `steps` or `room` sets; returns how many were written. */
EXPORTED int64_t list_groups(int robots, const uint64_t *neighbours, const uint64_t *protected_links, int64_t most,
                             Branch *stack, int64_t *position, int64_t steps, int64_t room, uint64_t *groups, uint16_t *cuts) {
    int64_t found = 0;
    while (steps-- > 0 && found < room) {
        if (position[1] == 0) {
            if (position[0] == robots) break;
            int first = (int)position[0]++;
            uint64_t below = ((uint64_t)1 << first) - 1;
            stack[0] = (Branch){(uint64_t)1 << first, below, neighbours[first], size_of(neighbours[first] & below)};
            position[1] = (protected_links[first] & below) == 0;
            continue;
        }
        Branch node = stack[--position[1]];
        int64_t cut = node.cut;
        int pick = most_linked(neighbours, &node, &cut);
        if (cut > most) continue;
        if (pick < 0) {
            groups[found] = node.inside;
            cuts[found++] = (uint16_t)node.cut;
            continue;
        }
        uint64_t bit = (uint64_t)1 << pick;
        int64_t inside = size_of(neighbours[pick] & node.inside), outside = size_of(neighbours[pick] & node.outside);
        if (!(protected_links[pick] & node.inside))
            stack[position[1]++] = (Branch){node.inside, node.outside | bit, node.near, node.cut + inside};
        if (!(protected_links[pick] & node.outside))
            stack[position[1]++] = (Branch){node.inside | bit, node.outside, node.near | neighbours[pick], node.cut + outside};
    }
    return found;
}

/* Keep the groups in which blinding at most `most` robots leaves a set below the threshold, and how many it takes.
   `sizes`: of the largest such set inside each set, plus one, or 0. Returns how many are kept. */
EXPORTED int64_t keep_reachable(const uint8_t *sizes, int64_t count, const uint32_t *groups, const uint8_t *cuts, int most,
                                uint32_t *kept, uint8_t *kept_cuts, uint8_t *blinded) {
    int64_t n = 0;
    for (int64_t k = 0; k < count; k++) {
        int blind = size_of(groups[k]) + 1 - sizes[groups[k]];
        if (sizes[groups[k]] == 0 || blind > most) continue;
        kept[n] = groups[k], kept_cuts[n] = cuts[k], blinded[n++] = (uint8_t)blind;
    }
    return n;
}

static inline uint64_t group_at(const Columns *c, int64_t k) {
    return c->wide ? ((const uint64_t *)c->groups)[k] : ((const uint32_t *)c->groups)[k];
}

static inline int64_t reduced_cost(const Columns *c, int64_t k, const Duals *duals) {
    int64_t cost = c->cuts[k] * duals->unit + c->blinded[k] * duals->blinding;
    const int64_t *sums = duals->sums;
    for (uint64_t rest = group_at(c, k); rest; rest >>= PART, sums += 1 << PART) cost -= sums[rest & ((1 << PART) - 1)];
    return cost;
}

/* The column of least reduced cost with each robot, (robots) where it is negative, else -1; returns the least of all. */
EXPORTED int64_t price(int robots, const Columns *columns, const Duals *duals, int64_t *cheapest) {
    int64_t best[64], least = INT64_MAX, worst = -1;
    for (int i = 0; i < robots; i++) best[i] = -1, cheapest[i] = -1;
    for (int64_t k = 0; k < columns->count; k++) {
        int64_t cost = reduced_cost(columns, k, duals);
        if (cost < least) least = cost;
        if (cost >= worst) continue;
        for (uint64_t rest = group_at(columns, k); rest; rest &= rest - 1) {
            int i = lowest(rest);
            if (cost < best[i]) best[i] = cost, cheapest[i] = k;
        }
        worst = best[0];
        for (int i = 1; i < robots; i++) worst = best[i] > worst ? best[i] : worst;
    }
    return least;
}

/* The columns of a reduced cost of at most `gap`, as many as there is `room` for; returns how many there are. */
EXPORTED int64_t within_gap(const Columns *columns, const Duals *duals, int64_t gap, int64_t room, int64_t *chosen,
                            int64_t *costs) {
    int64_t n = 0;
    for (int64_t k = 0; k < columns->count; k++) {
        int64_t cost = reduced_cost(columns, k, duals);
        if (cost > gap) continue;
        if (n < room) chosen[n] = k, costs[n] = cost;
        n++;
    }
    return n;
}

/* At most `size` robots of `set` sense in a group that has those of `protected` in `set`. Raises the robots to blind, and keeps
   the columns in which at most `most` are, in place; returns how many. */
EXPORTED int64_t restrict_columns(Columns *columns, uint64_t set, int size, uint64_t protected, int most) {
    int64_t n = 0;
    for (int64_t k = 0; k < columns->count; k++) {
        uint64_t group = group_at(columns, k);
        int blinded = columns->blinded[k];
        if (!(set & protected & ~group) && size_of(group & set) - size > blinded) blinded = size_of(group & set) - size;
        if (blinded > most) continue;
        if (columns->wide) ((uint64_t *)columns->groups)[n] = group;
        else ((uint32_t *)columns->groups)[n] = (uint32_t)group;
        columns->cuts[n] = columns->cuts[k], columns->blinded[n++] = (uint8_t)blinded;
    }
    columns->count = n;
    return n;
}
