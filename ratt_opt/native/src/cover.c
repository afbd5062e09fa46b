/* Exact covers of a team by groups, within the budgets and a sum of reduced costs. */
#include <string.h>

#include "groups.h"

enum { FOUND = 1, NONE = 0, PAUSED = -1, NO_ROOM = -2 };

/* The robot not covered yet with the fewest columns. */
static int rarest(const Cover *cover, const Level *level, const uint64_t *left) {
    int pick = -1;
    memset(cover->counts, 0, (size_t)cover->robots * sizeof(int64_t));
    for (int64_t k = level->start; k < level->end; k++)
        for (int64_t w = 0; w < cover->words; w++)
            for (uint64_t rest = cover->groups[cover->fitting[k] * cover->words + w]; rest; rest &= rest - 1)
                cover->counts[64 * w + lowest(rest)]++;
    for (int i = 0; i < cover->robots; i++)
        if (left[i >> 6] >> (i & 63) & 1 && (pick < 0 || cover->counts[i] < cover->counts[pick])) pick = i;
    return pick;
}

int next_cover(Cover *cover, int64_t steps) {
    const int64_t words = cover->words;
    while (cover->depth >= 0) {
        Level *level = cover->levels + cover->depth, *next = level + 1;
        uint64_t *left = cover->left + cover->depth * words, *after = left + words;
        if (steps <= 0) return PAUSED;
        if (level->robot < 0) {
            if (cover->nodes >= cover->most_nodes) return PAUSED;
            cover->nodes++;
            steps -= level->end - level->start;
            level->robot = rarest(cover, level, left);
            level->position = level->start;
        }
        int64_t at = level->position, word = level->robot >> 6;
        while (at < level->end && !(cover->groups[cover->fitting[at] * words + word] >> (level->robot & 63) & 1)) at++;
        if (at >= level->end) {
            cover->depth--;
            continue;
        }
        int32_t column = cover->fitting[at];
        const int64_t *cost = cover->costs + 3 * (int64_t)column;
        *next = (Level){{level->room[0] - cost[0], level->room[1] - cost[1], level->room[2] - cost[2]}, level->end, level->end, 0, -1, -1};
        level->position = at + 1;
        level->column = column;
        if (next->room[0] < 0 || next->room[1] < 0 || next->room[2] < 0) continue;
        uint64_t open = 0;
        for (int64_t w = 0; w < words; w++) open |= after[w] = left[w] & ~cover->groups[column * words + w];
        if (!open) return FOUND;
        if (level->end + (level->end - level->start) > cover->room) return NO_ROOM;
        int64_t k = level->start;
        for (; k < level->end; k++) {
            const int32_t other = cover->fitting[k];
            const int64_t *paid = cover->costs + 3 * (int64_t)other;
            const uint64_t *group = cover->groups + other * words;
            if (paid[0] > next->room[0]) break;
            int fits = paid[1] <= next->room[1] && paid[2] <= next->room[2];
            for (int64_t w = 0; w < words && fits; w++) fits = !(group[w] & ~after[w]);
            if (fits) cover->fitting[next->end++] = other;
        }
        steps -= k - level->start;
        if (next->end > next->start) cover->depth++; /* a robot that none of these has is found there at once */
    }
    return NONE;
}
