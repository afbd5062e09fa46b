/* Groups of negative reduced cost, by branch and bound. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "group_search.h"

enum { FINISHED, PAUSED, FOUND };
enum { ROUNDS = 4 };               /* of multipliers at a node */
static const double STEP = 1.5;    /* of what a linear model says, towards the limit */
static const double LINK = 0.05, BLIND = 0.2; /* weights of multipliers beside that of values: a link's, a blinded robot's */

static int is_open(int state) { return (state & OUTSIDE) && state != OUTSIDE; }

double bound_of(Search *s, const Node *node, Multipliers at, double room) {
    const double unit = (double)s->q.unit;
    double price = (double)s->q.blinding + at.blinded * unit, per = room > 0 ? at.value * unit / room : 0.0;
    for (int i = 0; i < s->robots; i++) {
        int state = node->state[i];
        double sense = state == SENSES ? 0.0 : state & SENSES ? per * s->weight[i] : INFINITY;
        s->sense[i] = !(state & BLINDED) || sense <= price;
        s->cost[i] = state == OUTSIDE ? 0 : (int64_t)floor(s->sense[i] ? sense : price) - s->q.duals[i];
    }
    double kept = at.value + at.cut * (double)(at.cut > 0 ? s->q.most_cut : node->cut);
    kept += at.blinded * (double)(at.blinded > 0 ? s->q.n_blinded : node->need);
    int64_t cut = least_cut(s, node->state, s->q.unit + (int64_t)floor(at.cut * unit));
    return (double)cut - kept * unit - s->robots - 2; /* as costs are rounded */
}

/* What a group uses of something that groups have from `least` to `most` of, beyond what its multiplier is about. */
static double beyond(double multiplier, double used, double least, double most) {
    if (multiplier > 0) return used - most;
    if (multiplier < 0) return used - least;
    return used > most ? used - most : used < least ? used - least : 0.0;
}

/* A multiplier after a step; it stops at 0 before it changes its sign. */
static double moved(double multiplier, double step, double lowest) {
    double after = multiplier + step;
    if (after * multiplier < 0) return 0.0;
    return after < lowest ? lowest : after;
}

int improve(const Search *s, const Node *node, Multipliers *at, double room, double bound) {
    double weight = 0, blinded = 0, links = 0;
    for (int i = 0; i < s->robots; i++) {
        if (!s->inside[i]) continue;
        if (!s->sense[i]) blinded++;
        else if (node->state[i] != SENSES) weight += s->weight[i];
        for (int64_t a = s->q.start[i]; a < s->q.start[i + 1]; a++) links += !s->inside[s->q.robot[a]];
    }
    double value = room > 0 ? weight / room - 1 : 0.0, unit = (double)s->q.unit;
    if (at->value <= 0 && value < 0) value = 0.0;
    blinded = BLIND * beyond(at->blinded, blinded, node->need, (double)s->q.n_blinded);
    links = LINK * beyond(at->cut, links, (double)node->cut, (double)s->q.most_cut);
    double square = value * value + blinded * blinded + links * links;
    if (!(square > 1e-12)) return 0;
    double step = STEP * ((double)s->q.limit - bound) / unit / square;
    at->value = fmax(at->value + step * value, 0.0);
    at->blinded = moved(at->blinded, step * BLIND * blinded, -(double)s->q.blinding / unit);
    at->cut = moved(at->cut, step * LINK * links, -1.0);
    return 1;
}

/* Sizes that groups of the node may have, and what follows of them; 0 where there are none. */
static int bound_sizes(const Search *s, Node *node) {
    int inside = 0, possible = 0, blinded = 0;
    for (int i = 0; i < s->robots; i++) {
        int state = node->state[i];
        if (!state) return 0;
        inside += IS_INSIDE(state), possible += state != OUTSIDE, blinded += state == BLINDED;
    }
    int most = node->most + (int)s->q.n_blinded;
    if (node->low < inside) node->low = inside;
    if (node->high > possible) node->high = possible;
    if (node->high > most) node->high = most;
    while (node->low <= node->high && s->q.least_cut[node->low] > s->q.most_cut) node->low++;
    while (node->low <= node->high && s->q.least_cut[node->high] > s->q.most_cut) node->high--;
    node->cut = s->q.most_cut;
    for (int size = node->low; size <= node->high; size++)
        if (s->q.least_cut[size] < node->cut) node->cut = s->q.least_cut[size];
    if (node->need < blinded) node->need = blinded;
    if (node->need < node->low - node->most) node->need = node->low - node->most;
    return node->low <= node->high && node->need <= s->q.n_blinded;
}

/* Whether a group of the node may cost less than the limit; `fresh`: one more robot senses for sure. */
static int may_pay(Search *s, Node *node, int fresh) {
    double room = weigh(s, node, fresh), best = -INFINITY;
    if (!bound_sizes(s, node)) return 0;
    Multipliers at = node->at;
    for (int round = 0; round < ROUNDS; round++) {
        double bound = bound_of(s, node, at, room);
        if (bound > best) best = bound, node->at = at;
        if (bound >= (double)s->q.limit) return 0;
        if (!improve(s, node, &at, room, bound)) break;
    }
    return 1;
}

void copy_node(const Search *s, const Node *from, Node *to) {
    Node arrays = *to;
    *to = *from;
    to->state = arrays.state, to->blind = arrays.blind, to->sums = arrays.sums, to->worth = arrays.worth;
    memcpy(to->state, from->state, (size_t)s->robots), memcpy(to->blind, from->blind, (size_t)s->robots);
    memcpy(to->sums, from->sums, (size_t)s->width * sizeof(double));
    memcpy(to->worth, from->worth, (size_t)s->robots * sizeof(double));
}

/* Keep those of the last node and the one after it that may pay. */
static void keep(Search *s, int first, int second) {
    Node *node = s->nodes + s->depth - 1;
    if (second && !first) copy_node(s, node + 1, node);
    s->depth += first + second - 1;
}

Node *begin(Search *s) {
    Node *node = s->nodes;
    for (int i = 0; i < s->robots; i++) node->state[i] = (int8_t)(SENSES | OUTSIDE | (s->q.seeing[i] ? 0 : BLINDED));
    memset(node->blind, 0, (size_t)s->robots);
    memcpy(node->sums, s->q.team->prior, (size_t)s->width * sizeof(double));
    node->need = node->found = 0, node->most = (int)s->q.most, node->low = 1, node->high = s->robots;
    node->at = (Multipliers){0.0, 0.0, 0.0};
    s->visited++;
    return node;
}

/* Decide that a robot is inside; returns whether it senses for sure. */
static int take_in(Search *s, Node *node, int robot) {
    node->state[robot] &= ~OUTSIDE;
    if (node->state[robot] != SENSES) return 0;
    add_information(s->q.team, node->sums, 1.0, robot, node->sums);
    return 1;
}

/* Split the last node at a number of robots that no group has; 0 where there is none. */
static int split_sizes(Search *s) {
    Node *node = s->nodes + s->depth - 1, *other = node + 1;
    int at = node->low + 1;
    while (at < node->high && s->q.least_cut[at] <= s->q.most_cut) at++;
    if (at >= node->high) return 0;
    s->visited += 2;
    copy_node(s, node, other);
    other->low = at + 1, node->high = at;
    int more = may_pay(s, other, 0), less = may_pay(s, node, 0);
    keep(s, less, more);
    return 1;
}

int next_to_group(const Search *s, const int8_t *state) {
    int best = -1, most = 0;
    for (int i = 0; i < s->robots; i++) {
        int decided = 0, touches = 0;
        if (!is_open(state[i])) continue;
        for (int64_t a = s->q.start[i]; a < s->q.start[i + 1]; a++) {
            int other = state[s->q.robot[a]];
            decided += !is_open(other);
            touches |= IS_INSIDE(other);
        }
        if (touches && decided > most) best = i, most = decided;
    }
    return best;
}

/* Record a group of robots that are `inside` if its links and its reduced cost are within the limits: `group` and `column` as
   rows of `list_groups_below`. */
static int record(const Search *s, const uint8_t *inside, const uint8_t *blind, int need, int found, int8_t *group, int64_t *column) {
    int64_t cut = 0, cost = s->q.blinding * need;
    for (int i = 0; i < s->robots; i++) {
        group[i] = (int8_t)(!inside[i] ? 0 : blind[i] ? 2 : 1);
        if (!inside[i]) continue;
        cost -= s->q.duals[i];
        for (int64_t a = s->q.start[i]; a < s->q.start[i + 1]; a++) cut += !inside[s->q.robot[a]];
    }
    column[0] = need, column[1] = found, column[2] = cut, column[3] = cost + cut * s->q.unit;
    return cut <= s->q.most_cut && column[3] < s->q.limit && need <= s->q.n_blinded;
}

/* Decide who is inside first, then who must be blinded: each group comes once. */
static int step(Search *s, int8_t *group, int64_t *column) {
    if (s->depth == 0) {
        if (s->first == s->robots) return FINISHED;
        Node *node = begin(s);
        for (int p = 0; p < s->first; p++) node->state[s->q.order[p]] = OUTSIDE;
        int robot = (int)s->q.order[s->first++];
        take_in(s, node, robot);
        s->depth = admit(s, node, robot) && may_pay(s, node, 1);
        return PAUSED;
    }
    if (split_sizes(s)) return PAUSED;
    Node *node = s->nodes + s->depth - 1, *other = node + 1;
    int robot = next_to_group(s, node->state);
    if (robot < 0) {
        for (int i = 0; i < s->robots; i++) s->inside[i] = IS_INSIDE(node->state[i]);
        if (record(s, s->inside, node->blind, node->need, node->found, group, column)) {
            settle(s, node);
            if (record(s, s->inside, node->blind, node->need, node->found, group, column)) return FOUND;
        }
        s->depth--;
        return PAUSED;
    }
    s->visited += 2;
    copy_node(s, node, other);
    int fresh = take_in(s, other, robot);
    node->state[robot] = OUTSIDE;
    int joins = admit(s, other, robot) && may_pay(s, other, fresh), stays = may_pay(s, node, 0);
    keep(s, stays, joins);
    return PAUSED;
}

void close_pricing(Search *s) {
    if (!s) return;
    if (s->nodes) free(s->nodes[0].state), free(s->nodes[0].sums);
    free(s->nodes), free(s->excess), free(s->distance), free(s->weight), free(s->inside), free(s);
}

Search *open_pricing(const Pricing *question) {
    Search *s = calloc(1, sizeof(Search));
    if (!s) return NULL;
    size_t n = (size_t)question->team->robots, nodes = 3 * n + 4, arcs = (size_t)question->start[n];
    size_t width = (size_t)question->team->targets * (size_t)entries_of(question->team);
    s->q = *question, s->robots = (int)n, s->width = (int)width, s->before = error_before(question->team);
    s->nodes = calloc(nodes, sizeof(Node));
    int8_t *states = malloc(nodes * 2 * n);
    double *sums = malloc(nodes * (width + n) * sizeof(double));
    if (s->nodes) s->nodes[0].state = states, s->nodes[0].sums = sums;
    s->excess = malloc((2 * n + arcs) * sizeof(int64_t));
    s->distance = malloc((3 * n + (n + 2) * n) * sizeof(int));
    s->weight = malloc((2 * n + width + (n + 2) * (width + n)) * sizeof(double));
    s->inside = malloc(3 * n);
    if (!s->nodes || !states || !sums || !s->excess || !s->distance || !s->weight || !s->inside) {
        if (!s->nodes) free(states), free(sums);
        close_pricing(s);
        return NULL;
    }
    for (size_t d = 0; d < nodes; d++) {
        s->nodes[d].state = states + 2 * d * n, s->nodes[d].blind = (uint8_t *)states + (2 * d + 1) * n;
        s->nodes[d].sums = sums + d * (width + n), s->nodes[d].worth = s->nodes[d].sums + width;
    }
    s->capacity = s->excess + n, s->cost = s->capacity + arcs;
    s->queue = s->distance + n, s->next = s->queue + n, s->order = s->next + n;
    s->sorted = s->weight + n, s->spare = s->sorted + n, s->sums = s->spare + width;
    s->sense = s->inside + n, s->chosen = s->sense + n;
    return s;
}

int list_groups_below(Search *s, int64_t nodes, int64_t room, int8_t *groups, int64_t *columns, int64_t *count, int64_t *progress) {
    int code = PAUSED;
    int64_t stop = s->visited + nodes;
    while (code != FINISHED && s->visited < stop && *count < room) {
        code = step(s, groups + *count * s->robots, columns + 4 * *count);
        if (code == FOUND) s->depth--, ++*count;
    }
    *progress = s->visited;
    return code == FINISHED ? FINISHED : PAUSED;
}

int64_t most_below(Search *s, const uint8_t *group) {
    Node *node = begin(s);
    int inside = 0;
    s->q.n_blinded = s->robots; /* all are inside, whatever it may cost, and any may be blinded */
    for (int i = 0; i < s->robots; i++) node->state[i] = group[i] ? SENSES | BLINDED : OUTSIDE, inside += group[i];
    weigh(s, node, 1);
    int most = node->most;
    while (most > 0 && !may_be_below(s, node, inside - most, s->q.effort)) most--;
    return most;
}
