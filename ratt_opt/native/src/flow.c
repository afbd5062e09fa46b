/* The group of least cost of links and robots, by a flow of most capacity: Dinic, Soviet Mathematics Doklady 11 (1970). */
#include "group_search.h"

static const int64_t NEVER = (int64_t)1 << 52;

/* Distances from robots that gain by being inside, along what is left of the links; whether one is reached that loses. */
static int set_distances(Search *s) {
    int head = 0, tail = 0, is_reached = 0;
    for (int i = 0; i < s->robots; i++) {
        s->distance[i] = s->excess[i] > 0 ? 0 : -1;
        if (s->excess[i] > 0) s->queue[tail++] = i;
    }
    while (head < tail) {
        int i = s->queue[head++];
        is_reached |= s->excess[i] < 0;
        for (int64_t a = s->q.start[i]; a < s->q.start[i + 1]; a++) {
            int j = (int)s->q.robot[a];
            if (s->capacity[a] > 0 && s->distance[j] < 0) s->distance[j] = s->distance[i] + 1, s->queue[tail++] = j;
        }
    }
    return is_reached;
}

static int64_t push(Search *s, int i, int64_t flow) {
    if (s->excess[i] < 0) {
        int64_t sent = flow < -s->excess[i] ? flow : -s->excess[i];
        s->excess[i] += sent;
        return sent;
    }
    for (; s->next[i] < s->q.start[i + 1]; s->next[i]++) {
        int64_t a = s->next[i];
        int j = (int)s->q.robot[a];
        if (s->capacity[a] <= 0 || s->distance[j] != s->distance[i] + 1) continue;
        int64_t sent = push(s, j, flow < s->capacity[a] ? flow : s->capacity[a]);
        if (sent > 0) {
            s->capacity[a] -= sent;
            s->capacity[s->q.back[a]] += sent;
            return sent;
        }
    }
    return 0;
}

int64_t least_cut(Search *s, const int8_t *state, int64_t link) {
    int n = s->robots;
    int64_t base = 0, sent = 0;
    for (int i = 0; i < n; i++) {
        int64_t cost = state[i] == OUTSIDE ? 0 : s->cost[i];
        if (IS_INSIDE(state[i]) || cost < 0) base += cost;
        s->excess[i] = IS_INSIDE(state[i]) ? NEVER : state[i] == OUTSIDE ? -NEVER : -cost;
    }
    for (int64_t a = 0; a < s->q.start[n]; a++) s->capacity[a] = s->q.fixed[a] ? NEVER : link;
    while (set_distances(s)) {
        for (int i = 0; i < n; i++) s->next[i] = (int)s->q.start[i];
        for (int i = 0; i < n; i++)
            while (s->excess[i] > 0) {
                int64_t flow = push(s, i, s->excess[i]);
                if (!flow) break;
                s->excess[i] -= flow, sent += flow;
            }
    }
    for (int i = 0; i < n; i++) s->inside[i] = s->distance[i] >= 0;
    return base + sent;
}
