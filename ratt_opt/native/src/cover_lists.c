/* Partitions of a team into listed groups, within budgets, robot by robot. */
#include <string.h>

#include "sets.h"
#include <stdint.h>

enum { FINISHED, PAUSED, FOUND };

/* Go on to the next partition. `groups` (count, robots) by their first robot, those of robot i are first[i]..first[i + 1] - 1;
   `costs` (count, 3) reduced cost, blinded robots, links, each >= 0; `budgets` (3); `position` (robots + 1) next group at each
   depth, -1 to begin; `covered` (robots + 1, robots); `spent` (robots + 1, 3); *depth < 0 at the end. */
EXPORTED int next_partition(int64_t robots, const uint8_t *groups, const double *costs, const double *budgets, const int64_t *first,
                            int64_t *position, uint8_t *covered, double *spent, int64_t *depth, int64_t steps) {
    while (*depth >= 0) {
        int64_t d = *depth, lowest = 0;
        const uint8_t *have = covered + d * robots;
        const double *used = spent + 3 * d;
        while (lowest < robots && have[lowest]) lowest++;
        if (lowest == robots) {
            --*depth;
            return FOUND;
        }
        int64_t k = position[d] < 0 ? first[lowest] : position[d] + 1;
        for (; k < first[lowest + 1]; k++, steps--) {
            const uint8_t *group = groups + k * robots;
            int fits = 1;
            for (int b = 0; b < 3; b++) fits &= used[b] + costs[3 * k + b] <= budgets[b];
            for (int64_t i = 0; i < robots && fits; i++) fits = !(have[i] && group[i]);
            if (fits) break;
        }
        position[d] = k;
        if (k == first[lowest + 1]) {
            --*depth;
            continue;
        }
        for (int64_t i = 0; i < robots; i++) covered[(d + 1) * robots + i] = have[i] | groups[k * robots + i];
        for (int b = 0; b < 3; b++) spent[3 * (d + 1) + b] = used[b] + costs[3 * k + b];
        position[d + 1] = -1;
        ++*depth;
        if (--steps <= 0) return PAUSED;
    }
    return FINISHED;
}
