/* Partitions of the team into groups of a list, one after the other. */
#include "records.h"
#include "sets.h"

enum { FOUND = 1, NONE = 0, PAUSED = -1 };

/* Links between a group and other robots. */
static int64_t links_between(const Partitions *p, uint64_t group, uint64_t others) {
    int64_t links = 0;
    for (; group; group &= group - 1) links += size_of(p->neighbours[lowest(group)] & others);
    return links;
}

/* Go on to the next partition, its groups in levels[0..depth]; PAUSED after `nodes` nodes or `steps` groups looked at. Each
   group has the lowest robot that is in none so far. */
EXPORTED int next_partition_into_groups(Partitions *p, int64_t nodes, int64_t steps) {
    int64_t limit = p->nodes + nodes;
    while (p->depth >= 0) {
        PartitionLevel *level = p->levels + p->depth, *below = level + 1;
        int64_t end = p->starts[lowest(level->left) + 1], group = level->next;
        while (group < end && steps > 0 && p->groups[group] & ~level->left) group++, steps--;
        level->next = group;
        if (group == end) {
            p->depth--;
            continue;
        }
        if (steps <= 0 || p->nodes >= limit) return PAUSED;
        p->nodes++, steps--, level->next++;
        uint64_t left = level->left & ~p->groups[group];
        int64_t cut = level->cut + links_between(p, p->groups[group], left);
        if (cut > p->most_cut) continue;
        level->group = group;
        if (!left) return FOUND;
        *below = (PartitionLevel){left, cut, p->starts[lowest(left)], -1};
        p->depth++;
    }
    return NONE;
}
