/* Groups that keep more link weight than their robots' prices, by branch and bound over who is inside.
 *
 * value(S) = weight of the links inside S - prices of S, for connected sets S of at most `room` robots (or their weight).
 * Each link between robots that are still free divides its weight between its ends (`flow`: the first end's part). With
 * robots inside, and a multiplier of the room that is left,
 *
 *   value(S) <= value(inside) + multiplier * room left + sum over free robots of max(0, given - price - multiplier * size),
 *
 * where a link between a free robot and one inside gives the free robot all its weight. A flow finds the division with
 * the least such bound. It is kept from node to node: the next one begins with it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "kept_links.h"

enum { FREE, INSIDE, OUTSIDE };
enum { CLOSED, OPEN, FULL };
enum { FINISHED = 0, PAUSED = 1 };
enum { SPLIT = 1, LEAF = 2 }; /* of the tree that is written */
enum { FIRST_ROUNDS = 30, ROUNDS = 5 };

typedef struct {
    uint8_t *state;
    double multiplier; /* where the search of a better one begins; < 0: nowhere */
    int64_t value, room;
} Node;

struct KeptSearch {
    KeptLinks *q;
    Node *nodes;
    int64_t *flow, *written, *excess, *bonus; /* (links) twice, the second as in the tree so far; (robots) twice */
    int *queue, *from, *via, *mark;           /* (robots) */
    int depth, stamp, dead;
    int64_t mean;                             /* weight of a link */
};

/* A line that bounds g(multiplier) = bound from below: its height at 0, and its slope. */
typedef struct {
    double at, slope;
} Line;

static int other_end(const KeptLinks *q, int64_t link, int i) {
    return (int)(q->ends[2 * link] == i ? q->ends[2 * link + 1] : q->ends[2 * link]);
}

static int is_first(const KeptSearch *s, int64_t link, int i) { return s->q->ends[2 * link] == i; }

/* What the end i of a link has of it, and so can give. */
static int64_t part_of(const KeptSearch *s, int64_t link, int i) {
    return is_first(s, link, i) ? s->flow[link] : s->q->weight[link] - s->flow[link];
}

static int both_free(const KeptSearch *s, const uint8_t *state, int64_t link) {
    return state[s->q->ends[2 * link]] == FREE && state[s->q->ends[2 * link + 1]] == FREE;
}

/* Mark the free robots that those in the queue reach through free ones, `seen`; along links that can give when `along`. */
static int reach(KeptSearch *s, const uint8_t *state, int tail, int seen, int along) {
    const KeptLinks *q = s->q;
    for (int head = 0; head < tail; head++) {
        int i = s->queue[head];
        for (int64_t a = q->start[i]; a < q->start[i + 1]; a++) {
            int j = other_end(q, q->arc[a], i);
            if (state[j] != FREE || s->mark[j] == seen) continue;
            if (along && part_of(s, q->arc[a], i) <= 0) continue;
            s->mark[j] = seen, s->queue[tail++] = j;
        }
    }
    return tail;
}

/* A path from a robot with an excess to one that lacks some: its end, or -1. Those reached without finding one are dead. */
static int path_from(KeptSearch *s, const uint8_t *state, int origin) {
    const KeptLinks *q = s->q;
    int seen = ++s->stamp, head = 0, tail = 0;
    s->queue[tail++] = origin, s->from[origin] = -1, s->mark[origin] = seen;
    while (head < tail) {
        int i = s->queue[head++];
        for (int64_t a = q->start[i]; a < q->start[i + 1]; a++) {
            int j = other_end(q, q->arc[a], i);
            if (state[j] != FREE || s->mark[j] == seen || s->mark[j] == s->dead) continue;
            if (part_of(s, q->arc[a], i) <= 0) continue;
            s->mark[j] = seen, s->from[j] = i, s->via[j] = (int)q->arc[a];
            if (s->excess[j] < 0) return j;
            s->queue[tail++] = j;
        }
    }
    for (int k = 0; k < tail; k++) s->mark[s->queue[k]] = s->dead;
    return -1;
}

/* Send along the path to `goal` as much as is left at its origin, lacks at its end, and every link can give. */
static void send_to(KeptSearch *s, int origin, int goal) {
    int64_t amount = s->excess[origin] < -s->excess[goal] ? s->excess[origin] : -s->excess[goal];
    for (int j = goal; s->from[j] >= 0; j = s->from[j]) {
        int64_t part = part_of(s, s->via[j], s->from[j]);
        if (part < amount) amount = part;
    }
    for (int j = goal; s->from[j] >= 0; j = s->from[j]) s->flow[s->via[j]] += is_first(s, s->via[j], s->from[j]) ? -amount : amount;
    s->excess[origin] -= amount, s->excess[goal] += amount;
}

/* Divide links until at most `enough` excess is left, or the least: the sum of what is left. */
static int64_t even_out(KeptSearch *s, const uint8_t *state, int64_t enough) {
    int robots = (int)s->q->robots, goal;
    int64_t left = 0;
    s->dead = ++s->stamp;
    for (int i = 0; i < robots; i++)
        if (state[i] == FREE && s->excess[i] > 0) left += s->excess[i];
    for (int i = 0; i < robots; i++)
        while (left > enough && state[i] == FREE && s->excess[i] > 0 && s->mark[i] != s->dead && (goal = path_from(s, state, i)) >= 0) {
            int64_t before = s->excess[i];
            send_to(s, i, goal);
            left -= before - s->excess[i];
        }
    return left;
}

/* Divide links so that the least excess is left. Marks `stamp` on the best set of free robots. */
static int64_t balance(KeptSearch *s, const uint8_t *state) {
    int64_t left = even_out(s, state, 0);
    int tail = 0;
    s->stamp++;
    for (int i = 0; i < s->q->robots; i++)
        if (state[i] == FREE && s->excess[i] > 0) s->mark[i] = s->stamp, s->queue[tail++] = i;
    reach(s, state, tail, s->stamp, 1);
    return left;
}

static void write_number(KeptLinks *q, int64_t number) {
    if (q->length < q->most_length) q->tree[q->length] = number;
    q->length++;
}

static void set_excess(KeptSearch *s, const uint8_t *state, int64_t multiplier) {
    const KeptLinks *q = s->q;
    for (int i = 0; i < q->robots; i++) s->excess[i] = s->bonus[i] - q->price[i] - multiplier * q->size[i];
    for (int64_t e = 0; e < q->links; e++) {
        if (!both_free(s, state, e)) continue;
        s->excess[q->ends[2 * e]] += s->flow[e], s->excess[q->ends[2 * e + 1]] += q->weight[e] - s->flow[e];
    }
}

/* Write a leaf: the multiplier, and the parts of links that changed since the last leaf. These are few if the division
   begins as the last leaf left it, and ends once it closes the case. */
static void write_leaf(KeptSearch *s, const Node *node, int64_t multiplier) {
    KeptLinks *q = s->q;
    if (!q->most_length) return;
    int64_t changed = 0;
    memcpy(s->flow, s->written, sizeof(int64_t) * (size_t)q->links);
    set_excess(s, node->state, multiplier);
    even_out(s, node->state, q->threshold - node->value - multiplier * node->room);
    for (int64_t e = 0; e < q->links; e++) changed += s->flow[e] != s->written[e];
    write_number(q, LEAF), write_number(q, multiplier), write_number(q, changed);
    for (int64_t e = 0; changed && e < q->links; e++) {
        if (s->flow[e] == s->written[e]) continue;
        write_number(q, e), write_number(q, s->flow[e]), s->written[e] = s->flow[e];
    }
}

/* Keep a group: robots inside, and free ones that are marked if `marked`. */
static int record(const KeptSearch *s, const uint8_t *state, int marked, int64_t value) {
    KeptLinks *q = s->q;
    if (q->found >= q->most_found) return 0;
    uint8_t *group = q->groups + q->found * q->robots;
    for (int i = 0; i < q->robots; i++) group[i] = state[i] == INSIDE || (marked && state[i] == FREE && s->mark[i] == s->stamp);
    q->values[q->found++] = value;
    return 1;
}

/* Put robots outside that are too heavy or that those inside cannot reach; the number of free ones. */
static int close_off(KeptSearch *s, Node *node, int *inside) {
    const KeptLinks *q = s->q;
    int tail = 0, free_robots = 0;
    s->stamp++;
    for (int i = 0; i < q->robots; i++) {
        if (node->state[i] == FREE && q->size[i] > node->room) node->state[i] = OUTSIDE;
        if (node->state[i] == INSIDE) s->mark[i] = s->stamp, s->queue[tail++] = i;
    }
    *inside = tail;
    if (tail) reach(s, node->state, tail, s->stamp, 0);
    for (int i = 0; i < q->robots; i++) {
        if (tail && node->state[i] == FREE && s->mark[i] != s->stamp) node->state[i] = OUTSIDE;
        free_robots += node->state[i] == FREE;
    }
    return free_robots;
}

/* What robots inside give to each free one. */
static void set_bonus(KeptSearch *s, const uint8_t *state) {
    const KeptLinks *q = s->q;
    for (int i = 0; i < q->robots; i++) {
        s->bonus[i] = 0;
        if (state[i] != FREE) continue;
        for (int64_t a = q->start[i]; a < q->start[i + 1]; a++)
            if (state[other_end(q, q->arc[a], i)] == INSIDE) s->bonus[i] += q->weight[q->arc[a]];
    }
}

/* The line of the set of all free robots. */
static Line all_free(const KeptSearch *s, const Node *node) {
    const KeptLinks *q = s->q;
    Line line = {(double)node->value, (double)node->room};
    for (int i = 0; i < q->robots; i++)
        if (node->state[i] == FREE) line.at += (double)(s->bonus[i] - q->price[i]), line.slope -= (double)q->size[i];
    for (int64_t e = 0; e < q->links; e++)
        if (both_free(s, node->state, e)) line.at += (double)q->weight[e];
    return line;
}

static double meeting(Line up, Line down) {
    double at = (up.at - down.at) / (down.slope - up.slope);
    return at > 0 ? fmin(at, (double)((int64_t)1 << 40)) : 0.0;
}

/* Look for a multiplier that closes the node: the bound is convex in it, and the best sets found on either side of the room
   are lines below it, which meet where to ask next. */
static int bound(KeptSearch *s, Node *node, int rounds) {
    KeptLinks *q = s->q;
    Line up = {(double)node->value, (double)node->room}, down = all_free(s, node);
    double multiplier = down.slope >= 0 ? 0.0 : node->multiplier < 0 ? meeting(up, down) : node->multiplier;
    for (int round = 0; round < rounds; round++) {
        int64_t whole = (int64_t)multiplier, used = 0;
        set_excess(s, node->state, whole);
        int64_t left = balance(s, node->state);
        if (node->value + whole * node->room + left <= q->threshold) {
            write_leaf(s, node, whole);
            return CLOSED;
        }
        for (int i = 0; i < q->robots; i++)
            if (node->state[i] == FREE && s->mark[i] == s->stamp) used += q->size[i];
        int64_t value = node->value + left + whole * used;
        Line line = {(double)value, (double)(node->room - used)};
        if (used <= node->room) {
            if (!q->listing && value > q->threshold && !record(s, node->state, 1, value)) return FULL;
            up = line;
            if (whole == 0) break;
        } else {
            down = line;
        }
        node->multiplier = multiplier;
        double next = down.slope >= 0 || up.slope - down.slope < 0.5 ? 0.0 : meeting(up, down);
        if (next > 0 ? fabs(next - multiplier) < 2.0 : whole == 0) break;
        multiplier = next;
    }
    node->multiplier = multiplier;
    return OPEN;
}

/* The free robot next to those inside that promises most, or any before the first is inside; -1: none. */
static int next_robot(const KeptSearch *s, const Node *node, int inside) {
    int best = -1;
    int64_t most = 0;
    for (int i = 0; i < s->q->robots; i++) {
        if (node->state[i] != FREE || (inside && s->bonus[i] == 0)) continue;
        int64_t gain = s->excess[i] + (s->mark[i] == s->stamp ? s->mean : 0) + s->bonus[i] / 2;
        if (best < 0 || gain > most) best = i, most = gain;
    }
    return best;
}

/* Bound the last node, and close it or split it. */
static int examine(KeptSearch *s) {
    KeptLinks *q = s->q;
    Node *node = s->nodes + s->depth - 1, *other = node + 1;
    int inside;
    if (!close_off(s, node, &inside)) {
        if (inside && node->value > q->threshold && !record(s, node->state, 0, node->value)) return FULL;
        write_leaf(s, node, 0);
        return CLOSED;
    }
    set_bonus(s, node->state);
    int outcome = bound(s, node, inside ? ROUNDS : FIRST_ROUNDS);
    if (outcome != OPEN) return outcome;
    int robot = next_robot(s, node, inside);
    if (q->most_length) write_number(q, SPLIT), write_number(q, robot);
    memcpy(other->state, node->state, (size_t)q->robots);
    other->multiplier = node->multiplier;
    other->value = node->value + s->bonus[robot] - q->price[robot], other->room = node->room - q->size[robot];
    other->state[robot] = INSIDE, node->state[robot] = OUTSIDE;
    s->depth++;
    return OPEN;
}

void close_kept_links(KeptSearch *s) {
    if (!s) return;
    if (s->nodes) free(s->nodes[0].state);
    free(s->nodes), free(s->flow), free(s->queue), free(s);
}

KeptSearch *open_kept_links(KeptLinks *question) {
    KeptSearch *s = calloc(1, sizeof(KeptSearch));
    if (!s) return NULL;
    size_t n = (size_t)question->robots, m = (size_t)question->links;
    s->q = question;
    s->nodes = calloc(n + 2, sizeof(Node));
    uint8_t *states = calloc((n + 2) * (n + 1), 1);
    if (s->nodes) s->nodes[0].state = states;
    s->flow = calloc(2 * m + 2 * n + 1, sizeof(int64_t));
    s->queue = calloc(4 * n + 1, sizeof(int));
    if (!s->nodes || !states || !s->flow || !s->queue) {
        if (!s->nodes) free(states);
        close_kept_links(s);
        return NULL;
    }
    for (size_t d = 0; d < n + 2; d++) s->nodes[d].state = states + d * n;
    s->written = s->flow + m, s->excess = s->written + m, s->bonus = s->excess + n;
    s->from = s->queue + n, s->via = s->from + n, s->mark = s->via + n;
    for (size_t e = 0; e < m; e++) s->flow[e] = question->weight[e] / 2, s->mean += question->weight[e] / (int64_t)m;
    s->nodes[0].multiplier = -1.0, s->nodes[0].room = question->room, s->depth = 1;
    return s;
}

int search_kept_links(KeptSearch *s, int64_t nodes) {
    for (int64_t k = 0; s->depth > 0; k++) {
        if (k == nodes) return PAUSED;
        s->q->nodes++;
        int outcome = examine(s);
        if (outcome == FULL) return FULL;
        if (outcome == CLOSED) s->depth--;
    }
    return FINISHED;
}
