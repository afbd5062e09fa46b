/* Columns of the master: the groups that an attack may leave, what each costs, and those that duals would buy. */
#include "groups.h"

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

int64_t list_groups(int robots, const uint64_t *neighbours, const uint64_t *protected_links, int64_t most, Branch stack[],
                    int64_t *position, int64_t steps, int64_t room, uint64_t *groups, uint16_t *cuts) {
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

static inline uint64_t group_at(const Columns *c, int64_t k) {
    return c->wide ? ((const uint64_t *)c->groups)[k] : ((const uint32_t *)c->groups)[k];
}

static inline int64_t reduced_cost(const Columns *c, int64_t k, const Duals *duals) {
    int64_t cost = c->cuts[k] * duals->unit + c->blinded[k] * duals->blinding;
    const int64_t *sums = duals->sums;
    for (uint64_t rest = group_at(c, k); rest; rest >>= PART, sums += 1 << PART) cost -= sums[rest & ((1 << PART) - 1)];
    return cost;
}

int64_t price(int robots, const Columns *columns, const Duals *duals, int64_t *cheapest) {
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

int64_t within_gap(const Columns *columns, const Duals *duals, int64_t gap, int64_t room, int64_t *chosen, int64_t *costs) {
    int64_t n = 0;
    for (int64_t k = 0; k < columns->count; k++) {
        int64_t cost = reduced_cost(columns, k, duals);
        if (cost > gap) continue;
        if (n < room) chosen[n] = k, costs[n] = cost;
        n++;
    }
    return n;
}

int64_t restrict_columns(Columns *columns, uint64_t set, int size, uint64_t protected, int most) {
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
