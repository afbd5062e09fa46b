/* How many robots of a group must be blinded: whether the others, or some of them, are worth less than the threshold. */
#include <math.h>
#include <string.h>

#include "group_search.h"

enum { QUICK = 60 }; /* robots valued at a node, for each robot, to decide what a group needs */

/* Whether `size` of the `count` robots in row `depth` of `order`, besides those in row `depth` of sums, are below the
   threshold: 1, 0, or -1 where `effort` is spent. The copies of the robot that is worth least come first. */
static int some_are_below(Search *s, int depth, int count, int size, int64_t *effort) {
    int n = s->robots, *order = s->order + depth * n;
    double *sums = s->sums + (size_t)depth * (s->width + n), *worth = sums + s->width;
    if (size == 0) return value_of(s->q.team, sums) < s->q.threshold;
    if (count < size) return 0;
    if (*effort <= 0) return -1;
    *effort -= count;
    for (int p = 0; p < count; p++) {
        int robot = order[p], at = p;
        double level = level_of_copies(s, sums, size, robot);
        for (; at > 0 && worth[at - 1] > level; at--) worth[at] = worth[at - 1], order[at] = order[at - 1];
        worth[at] = level, order[at] = robot;
    }
    double sum = 0.0;
    for (int p = 0; p < size; p++) sum += worth[p];
    for (int p = 0; p + size <= count; p++) { /* sets whose first robot is this one */
        if (p > 0) sum += worth[p + size - 1] - worth[p - 1];
        if (sum >= size * s->q.level * (1 + ROUNDING)) return 0;
        add_information(s->q.team, sums, 1.0, order[p], sums + s->width + n);
        memcpy(order + n, order + p + 1, (size_t)(count - p - 1) * sizeof(int));
        int answer = some_are_below(s, depth + 1, count - p - 1, size - 1, effort);
        if (answer == 1) s->chosen[order[p]] = 1;
        if (answer) return answer;
    }
    return 0;
}

int may_be_below(Search *s, Node *node, int blinded, int64_t effort) {
    int count = 0, size = -blinded;
    memcpy(s->sums, s->q.team->prior, (size_t)s->width * sizeof(double));
    memset(s->chosen, 0, (size_t)s->robots);
    for (int i = 0; i < s->robots; i++) {
        if (!IS_INSIDE(node->state[i])) continue;
        size++;
        if (!(node->state[i] & SENSES)) continue;
        if (node->state[i] & BLINDED) {
            s->order[count++] = i;
        } else {
            add_information(s->q.team, s->sums, 1.0, i, s->sums);
            s->chosen[i] = 1;
            size--;
        }
    }
    if (size < 0) size = 0; /* more may be blinded than there are */
    int answer = some_are_below(s, 0, count, size, &effort);
    if (answer == 1)
        for (int i = 0; i < s->robots; i++) node->blind[i] = IS_INSIDE(node->state[i]) && !s->chosen[i];
    return answer;
}

static int is_below(Search *s, const Node *node) {
    memcpy(s->sums, s->q.team->prior, (size_t)s->width * sizeof(double));
    for (int i = 0; i < s->robots; i++)
        if (IS_INSIDE(node->state[i]) && !node->blind[i]) add_information(s->q.team, s->sums, 1.0, i, s->sums);
    return value_of(s->q.team, s->sums) < s->q.threshold;
}

/* A robot has come in: at least as many are blinded as before, or one more where that is not enough. 0: more than may be. */
int admit(Search *s, Node *node, int robot) {
    node->blind[robot] = 0;
    if ((node->state[robot] & SENSES) && is_below(s, node)) return 1;
    int answer = may_be_below(s, node, node->need, QUICK * s->robots);
    if (answer == 0) node->need++;
    if (node->need > s->q.n_blinded) return 0;
    if (answer != 1) { /* blind it, and others where it is not enough */
        int more = robot;
        while (more >= 0) {
            if (node->state[more] & BLINDED) node->blind[more] = 1;
            if (is_below(s, node)) break;
            for (more = s->robots - 1; more >= 0; more--)
                if (IS_INSIDE(node->state[more]) && !node->blind[more] && (node->state[more] & BLINDED)) break;
        }
        if (more < 0) return 0;
    }
    node->found = 0;
    for (int i = 0; i < s->robots; i++) node->found += node->blind[i];
    return 1;
}

/* The least number of blinded robots, as far as can be told. */
void settle(Search *s, Node *node) {
    while (node->need < node->found && node->need <= s->q.n_blinded) {
        int answer = may_be_below(s, node, node->need, s->q.effort);
        if (answer < 0) return;
        if (answer) node->found = node->need;
        else node->need++;
    }
}
