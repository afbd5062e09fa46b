/* Proofs that no group of an attack is below the threshold at a small cost: trees of cases, each closed by a rule that a checker
   can follow (ratt_opt/certificates/verifier). Flows that close one case are kept, and tried on the next. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "group_search.h"

enum { FINISHED, PAUSED, FULL, OPEN };
enum { SENSE, INSIDE, SENSING, BLINDED_ARE, LIMIT, WORTH, COPIES, BUDGET, FLOW, LISTED }; /* what is written of a node, with a number */
enum { ROUNDS = 8 };             /* of multipliers at a case */
enum { TRIED = 64 };             /* kept flows, those that closed a case last */
/* Robots valued at a case, for each robot, to find how many are blinded, and to show it; the latter in one group, too. */
enum { QUICK = 60, WRITTEN = 600, OF_ONE = 10000 };

/* Of a node, `low` robots are blinded as far as is written, and `need` as far as is found; `found`: one more senses for sure. */
typedef struct {
    Search *s;
    int robots, arcs;
    GroupTree *out;
    int64_t *gains; /* (2 robots) */
    uint8_t *seen;  /* (robots) */
    int *queue;     /* (robots) */
    Row *rows;      /* (robots + 1) */
    int by_limits;  /* whether limits close rows */
} Proof;

static int count_sure(const Proof *p, const Node *node) {
    int count = 0;
    for (int i = 0; i < p->robots; i++) count += node->state[i] == SENSES;
    return count;
}

/* Robots inside that may be blinded. */
static int count_unsure(const Proof *p, const Node *node) {
    int count = 0;
    for (int i = 0; i < p->robots; i++) count += IS_INSIDE(node->state[i]) && node->state[i] != SENSES;
    return count;
}

static void write_node(Proof *p, int kind, int64_t number) {
    int64_t *at = p->out->nodes + 2 * p->out->count++;
    at[0] = kind, at[1] = number;
}

static int compare_gains(const void *a, const void *b) {
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return x < y ? 1 : x > y ? -1 : 0;
}

/* The least cost of the case's groups of which at least `blinded` robots are, by a kept flow: `flow` has the price of blinding,
   of cuts, and what each arc carries. */
static int64_t cost_by(const Proof *p, const Node *node, const int64_t *flow, int blinded) {
    const Pricing *q = &p->s->q;
    int64_t link = q->unit + flow[1], price = q->blinding + flow[0];
    int64_t total = -flow[1] * q->most_cut - flow[0] * q->n_blinded;
    int room = node->most, within = 0, count = 0, n_inner = 0;
    int64_t *inner = p->gains + p->robots;
    for (int i = 0; i < p->robots; i++) {
        int state = node->state[i];
        int64_t in = -q->duals[i], out = 0;
        if (state == OUTSIDE) continue;
        room -= state == SENSES;
        within += IS_INSIDE(state) && state != SENSES, blinded -= state == (BLINDED | OUTSIDE);
        for (int64_t a = q->start[i]; a < q->start[i + 1]; a++) {
            int other = node->state[q->robot[a]];
            if (other == OUTSIDE) in += link;
            else if (IS_INSIDE(state)) continue;
            else if (IS_INSIDE(other)) out += link;
            else in += flow[2 + a];
        }
        if (state == SENSES) {
            total += in;
            continue;
        }
        int64_t best = state & BLINDED ? in + price : INT64_MAX;
        if ((state & OUTSIDE) && out < best) best = out;
        total += best;
        if (!(state & SENSES) || in >= best) continue;
        if (IS_INSIDE(state)) inner[n_inner++] = best - in;
        else p->gains[count++] = best - in;
    }
    if (blinded > 0) within -= blinded; /* who can only be blinded, elsewhere, does not count */
    qsort(inner, (size_t)n_inner, sizeof(int64_t), compare_gains);
    for (int k = 0; k < n_inner && k < within; k++) p->gains[count++] = inner[k];
    qsort(p->gains, (size_t)count, sizeof(int64_t), compare_gains);
    for (int k = 0; k < count && k < room; k++) total -= p->gains[k];
    return total;
}

static const int64_t *flow_at(const Proof *p, int64_t number) { return p->out->flows + number * (p->arcs + 2); }

/* The number of a kept flow that closes the case, if so many robots are blinded in its groups; -1 where none does. */
static int64_t closing_flow(Proof *p, const Node *node, int blinded) {
    int64_t *recent = p->out->recent;
    for (int64_t k = 0; k < p->out->n_flows && k < TRIED; k++) {
        int64_t number = recent[k];
        if (cost_by(p, node, flow_at(p, number), blinded) <= p->out->limit) continue;
        memmove(recent + 1, recent, (size_t)k * sizeof(int64_t));
        recent[0] = number;
        return number;
    }
    return -1;
}

/* A new flow that closes the case: its number; -1 where none is found, -2 where there is no room for it. Sets the group at hand. */
static int64_t new_flow(Proof *p, Node *node) {
    Search *s = p->s;
    double best = -INFINITY, room = node->most - count_sure(p, node);
    Multipliers at = node->at;
    if (p->out->n_flows == p->out->most_flows) return -2;
    int64_t *flow = p->out->flows + p->out->n_flows * (p->arcs + 2);
    for (int i = 0; i < p->robots; i++) s->weight[i] = 1.0;
    for (int round = 0; round < ROUNDS; round++) {
        double bound = bound_of(s, node, at, room);
        int64_t never = (int64_t)1 << 52, link;
        if (bound > best) best = bound, node->at = at;
        flow[0] = at.blinded > 0 ? (int64_t)(at.blinded * (double)s->q.unit) : 0, flow[1] = (int64_t)floor(at.cut * (double)s->q.unit);
        link = s->q.unit + flow[1];
        for (int64_t a = 0; a < p->arcs; a++) flow[2 + a] = (s->q.fixed[a] ? never : link) - s->capacity[a];
        if (cost_by(p, node, flow, node->need) > p->out->limit) {
            memmove(p->out->recent + 1, p->out->recent, (size_t)p->out->n_flows * sizeof(int64_t));
            return p->out->recent[0] = p->out->n_flows++;
        }
        if (!improve(s, node, &at, room, fmin(bound, (double)s->q.limit - 1))) break;
    }
    return -1;
}

/* Whether some robot inside is not connected to the others inside. */
static int is_apart(Proof *p, const Node *node) {
    const Pricing *q = &p->s->q;
    int head = 0, tail = 0, inside = 0, reached = 0;
    memset(p->seen, 0, (size_t)p->robots);
    for (int i = 0; i < p->robots; i++) {
        if (!IS_INSIDE(node->state[i])) continue;
        if (!inside++) p->seen[i] = 1, p->queue[tail++] = i;
    }
    while (head < tail) {
        int i = p->queue[head++];
        reached += IS_INSIDE(node->state[i]);
        for (int64_t a = q->start[i]; a < q->start[i + 1]; a++) {
            int j = (int)q->robot[a];
            if (!p->seen[j] && node->state[j] != OUTSIDE) p->seen[j] = 1, p->queue[tail++] = j;
        }
    }
    return reached < inside;
}

/* Blinded robots of the case's groups, at least, as far as is written. */
static int least_blinded(const Proof *p, const Node *node) {
    int open = 0, more = node->most - count_sure(p, node);
    for (int i = 0; i < p->robots; i++) open += IS_INSIDE(node->state[i]) && MAY_SENSE(node->state[i]);
    int need = count_unsure(p, node) - (more < open ? more : open);
    return need > node->low ? need : node->low;
}

/* Robots with one of some bits in their state, and without others; none if there are no limits to ask about them. */
static uint64_t robots_that(const Proof *p, const Node *node, int with, int without) {
    uint64_t set = 0;
    for (int i = 0; p->out->n_limits && i < p->robots; i++) set |= (uint64_t)((node->state[i] & with) && !(node->state[i] & without)) << i;
    return set;
}

/* Blinded robots at least, and robots that sense at most, as a limit says of a group with some robots and perhaps others. */
static int blinded_by(const GroupTree *out, int64_t limit, uint64_t inside) {
    return size_of(inside & out->limited[limit]) - (int)out->most[limit];
}

static int sensing_by(const GroupTree *out, int64_t limit, uint64_t may_sense) {
    return size_of(may_sense & ~out->limited[limit]) + (int)out->most[limit];
}

/* A limit that says that so many robots are blinded; if it can be, one that the tree has already. -1 if none does. */
static int64_t limit_for(const Proof *p, const Node *node, int blinded) {
    const GroupTree *out = p->out;
    int64_t best = -1;
    uint64_t inside = robots_that(p, node, SENSES | BLINDED, OUTSIDE);
    for (int64_t k = 0; k < out->n_limits; k++)
        if ((best < 0 || out->uses[k] > out->uses[best]) && blinded_by(out, k, inside) >= blinded) best = k;
    return best;
}

/* Blinded robots of the case's groups, at least, as far as is written or a limit says. */
static int known_blinded(const Proof *p, const Node *node) {
    int blinded = least_blinded(p, node);
    uint64_t inside = robots_that(p, node, SENSES | BLINDED, OUTSIDE);
    for (int64_t k = 0; k < p->out->n_limits; k++) {
        int by = blinded_by(p->out, k, inside);
        if (by > blinded) blinded = by;
    }
    return blinded;
}

static void write_limit(Proof *p, Node *node, int64_t limit) {
    int most = sensing_by(p->out, limit, robots_that(p, node, SENSES, 0));
    int low = blinded_by(p->out, limit, robots_that(p, node, SENSES | BLINDED, OUTSIDE));
    write_node(p, LIMIT, limit);
    p->out->uses[limit]++;
    if (most < node->most) node->most = most;
    if (low > node->low) node->low = low;
}

/* Whether no group of the case is within the budgets. */
static int is_beyond(Proof *p, const Node *node) {
    const Pricing *q = &p->s->q;
    int64_t cut = 0;
    if (count_sure(p, node) > node->most || least_blinded(p, node) > q->n_blinded) return 1;
    for (int i = 0; i < p->robots; i++) {
        if (!IS_INSIDE(node->state[i])) continue;
        for (int64_t a = q->start[i]; a < q->start[i + 1]; a++) {
            if (node->state[q->robot[a]] != OUTSIDE) continue;
            if (q->fixed[a]) return 1;
            cut++;
        }
    }
    return cut > q->most_cut || is_apart(p, node);
}

/* Whether any `size` of the open robots bring the robots that sense to the threshold, as far as copies tell. */
static int copies_are_enough(Proof *p, const Node *node, int size) {
    double *sorted = p->s->sorted;
    int count = 0;
    for (int i = 0; i < p->robots; i++)
        if (MAY_SENSE(node->state[i])) sorted[count++] = value_of_copies(p->s, node->sums, size, i);
    if (count < size) return 0;
    double sum = sum_of_least(sorted, count, size);
    return p->out->averages ? sum >= size * p->s->q.threshold : sorted[0] >= p->s->q.threshold;
}

/* A row of the search: what senses, and the worth of copies of each robot; those of least worth come first. */
static void open_row(Proof *p, Row *rows, int depth, int count, int size, uint64_t sensing) {
    Search *s = p->s;
    int *order = s->order + depth * p->robots;
    double *sums = s->sums + (size_t)depth * (s->width + p->robots), *worth = sums + s->width;
    rows[depth] = (Row){sensing, count, 0, size};
    for (int k = 0; size > 0 && k < count; k++) {
        int robot = order[k], at = k;
        double value = value_of_copies(s, sums, size, robot);
        for (; at > 0 && worth[at - 1] > value; at--) worth[at] = worth[at - 1], order[at] = order[at - 1];
        worth[at] = value, order[at] = robot;
    }
}

/* A limit that says that no set of the row is below the threshold: too many of its robots would sense. -1 if none does. */
static int64_t closing_limit(const Proof *p, const Row *row, int depth) {
    const GroupTree *out = p->out;
    const int *order = p->s->order + depth * p->robots;
    uint64_t may_sense = row->sensing;
    if (!p->by_limits) return -1;
    for (int k = row->first; k < row->count; k++) may_sense |= (uint64_t)1 << order[k];
    for (int64_t k = 0; k < out->n_limits; k++)
        if (sensing_by(out, k, may_sense) < size_of(row->sensing) + row->size) return k;
    return -1;
}

/* What closes a row: a leaf, -1 if it has to branch, -2 if what senses is worth less and nobody more does. */
static int closing_leaf(const Proof *p, const Row *row, int depth) {
    const Search *s = p->s;
    const double *sums = s->sums + (size_t)depth * (s->width + p->robots), *worth = sums + s->width;
    double sum = 0.0;
    if (row->size == 0) return value_of(s->q.team, sums) < s->q.threshold ? -2 : WORTH;
    if (row->count - row->first < row->size) return BUDGET;
    for (int k = row->first; k < row->first + row->size; k++) sum += p->out->averages ? worth[k] : worth[row->first];
    return sum >= row->size * s->q.threshold ? COPIES : -1;
}

/* Go on with the tree of the rows down to `*depth`: FINISHED, OPEN if some set is worth less, FULL, or PAUSED once so many robots
   were valued. */
static int write_sets(Proof *p, Row rows[], int32_t *depth, int64_t effort) {
    Search *s = p->s;
    int n = p->robots;
    while (*depth >= 0) {
        Row *row = rows + *depth;
        int leaf = closing_leaf(p, row, *depth);
        int64_t limit = leaf == -1 ? closing_limit(p, row, *depth) : -1;
        if (leaf == -2) return OPEN;
        if (limit >= 0) write_node(p, LIMIT, limit), leaf = BUDGET;
        if (leaf >= 0) {
            write_node(p, leaf, 0);
            if (--*depth >= 0) rows[*depth].first++;
            continue;
        }
        if (p->out->count + 2 * n + 4 > p->out->capacity) return FULL; /* two nodes may close each row down to this one's child */
        if (effort <= 0) return PAUSED;
        int *order = s->order + *depth * n, left = row->count - row->first - 1;
        double *sums = s->sums + (size_t)*depth * (s->width + n);
        write_node(p, SENSE, order[row->first]);
        add_information(s->q.team, sums, 1.0, order[row->first], sums + s->width + n);
        memcpy(order + n, order + row->first + 1, (size_t)left * sizeof(int));
        open_row(p, rows, ++*depth, left, row->size - 1, row->sensing | (p->by_limits ? (uint64_t)1 << order[row->first] : 0));
        effort -= left;
    }
    return FINISHED;
}

/* Write a tree over the robots inside of which any `size` besides those that sense are worth the threshold; 0 if that is not shown,
   and then nothing is written. */
static int write_inside(Proof *p, const Node *node, int size, int64_t effort) {
    Search *s = p->s;
    int count = 0;
    int64_t before = p->out->count;
    memcpy(s->sums, node->sums, (size_t)s->width * sizeof(double));
    for (int i = 0; i < p->robots; i++)
        if (IS_INSIDE(node->state[i]) && MAY_SENSE(node->state[i])) s->order[count++] = i;
    int32_t depth = 0;
    open_row(p, p->rows, 0, count, size, 0);
    if (write_sets(p, p->rows, &depth, effort - count) == FINISHED) return 1;
    p->out->count = before;
    return 0;
}

/* Write that at least `blinded` robots are blinded, if that is not written already; 0 if it is not shown. */
static int write_blinded(Proof *p, Node *node, int blinded, int64_t effort) {
    if (blinded <= least_blinded(p, node)) return 1;
    int64_t limit = limit_for(p, node, blinded);
    if (limit >= 0) {
        write_limit(p, node, limit);
        return 1;
    }
    write_node(p, BLINDED_ARE, blinded);
    if (write_inside(p, node, count_unsure(p, node) - blinded + 1, effort)) {
        node->low = blinded;
        return 1;
    }
    p->out->count--;
    node->need = known_blinded(p, node);
    return 0;
}

/* Close the case by a kept flow, after as few blinded robots as it takes are shown; 0 if they are not. */
static int write_flow(Proof *p, Node *node, int64_t number, int64_t effort) {
    int blinded = least_blinded(p, node);
    while (blinded < node->need && cost_by(p, node, flow_at(p, number), blinded) <= p->out->limit) blinded++;
    if (!write_blinded(p, node, blinded, effort)) return 0;
    write_node(p, FLOW, number);
    return 1;
}

/* Find robots that must be blinded, without writing it yet. 1: more than may be, and all of it is written. */
static int find_blinded(Proof *p, Node *node, int64_t effort, int64_t written_effort) {
    int unsure = count_unsure(p, node), most = (int)p->s->q.n_blinded, known = known_blinded(p, node);
    if (known > most && write_blinded(p, node, most + 1, 0)) {
        write_node(p, BUDGET, 0);
        return 1;
    }
    if (node->need < known) node->need = known;
    while (node->need <= most && node->need < unsure && !may_be_below(p->s, node, node->need, effort)) node->need++;
    if (node->need <= most) return 0;
    if (write_inside(p, node, unsure - most, written_effort)) return 1;
    node->need = known;
    return 0;
}

/* Write the limit that lets the fewest robots sense, if they are fewer than is known. */
static void limit_sensing(Proof *p, Node *node) {
    int64_t best = -1;
    int fewest = node->most;
    uint64_t may_sense = robots_that(p, node, SENSES, 0);
    for (int64_t k = 0; k < p->out->n_limits; k++) {
        int most = sensing_by(p->out, k, may_sense);
        if (most < fewest) fewest = most, best = k;
    }
    if (best >= 0) write_limit(p, node, best);
}

/* Robots that would be worth the threshold do not sense, and no more sense than copies let. */
static void narrow(Proof *p, Node *node) {
    int sure = count_sure(p, node), open = 0;
    for (int i = 0; i < p->robots; i++) {
        if (!MAY_SENSE(node->state[i])) continue;
        if (node->found) node->worth[i] = value_of_copies(p->s, node->sums, 1, i);
        if (node->worth[i] < p->s->q.threshold) {
            open++;
            continue;
        }
        node->state[i] &= ~SENSES;
        write_node(p, SENSE, i), write_node(p, WORTH, 0);
    }
    node->found = 0;
    if (node->most > sure + open) node->most = sure + open;
    limit_sensing(p, node);
    int told = node->most;
    while (node->most > sure && copies_are_enough(p, node, node->most - sure)) node->most--;
    if (node->most < told) write_node(p, SENSING, node->most + 1), write_node(p, COPIES, 0);
}

/* The open robot inside of whose copies, as many as must sense, the value is least. */
static int weakest_inside(const Proof *p, const Node *node) {
    int best = -1, copies = count_unsure(p, node) - node->need;
    double least = INFINITY;
    for (int i = 0; i < p->robots; i++) {
        if (!MAY_SENSE(node->state[i]) || !IS_INSIDE(node->state[i])) continue;
        double value = value_of_copies(p->s, node->sums, copies > 0 ? copies : 1, i);
        if (value < least) least = value, best = i;
    }
    return best;
}

static int64_t cost_of_group(const Proof *p, const Node *node, int blinded) {
    const Pricing *q = &p->s->q;
    int64_t cost = q->blinding * (blinded > 0 ? blinded : 0);
    for (int i = 0; i < p->robots; i++) {
        if (!IS_INSIDE(node->state[i])) continue;
        cost -= q->duals[i];
        for (int64_t a = q->start[i]; a < q->start[i + 1]; a++) cost += q->unit * (node->state[q->robot[a]] == OUTSIDE);
    }
    return cost;
}

/* The next robot that is asked about: next to the group; the first one; or any that is neither inside nor outside. */
static int next_member(Proof *p, const Node *node) {
    Search *s = p->s;
    int robot = next_to_group(s, node->state), inside = 0;
    if (robot >= 0) return robot;
    for (int i = 0; i < p->robots; i++) inside += IS_INSIDE(node->state[i]);
    for (int k = 0; k < p->robots; k++) {
        robot = inside ? k : (int)s->q.order[k];
        if ((node->state[robot] & OUTSIDE) && node->state[robot] != OUTSIDE) return robot;
    }
    return -1;
}

/* Close the last case of the stack, list its group, or branch. */
static int expand(Proof *p) {
    Search *s = p->s;
    Node *node = s->nodes + s->depth - 1, *other = node + 1;
    int64_t written = (int64_t)WRITTEN * p->robots, of_one = (int64_t)OF_ONE * p->robots;
    int64_t quick = p->out->n_limits ? 0 : (int64_t)QUICK * p->robots; /* limits know as much, and are shorter to write */
    s->visited++, s->depth--;
    if (node->found && value_of(s->q.team, node->sums) >= s->q.threshold) {
        write_node(p, WORTH, 0);
        return PAUSED;
    }
    if (is_beyond(p, node)) {
        write_node(p, BUDGET, 0);
        return PAUSED;
    }
    int64_t number = closing_flow(p, node, least_blinded(p, node));
    if (number >= 0) {
        write_node(p, FLOW, number);
        return PAUSED;
    }
    if (find_blinded(p, node, quick, written)) return PAUSED;
    number = closing_flow(p, node, node->need);
    if (number >= 0 && write_flow(p, node, number, written)) return PAUSED;
    narrow(p, node);
    if (is_beyond(p, node)) {
        write_node(p, BUDGET, 0);
        return PAUSED;
    }
    number = closing_flow(p, node, node->need);
    if (number < 0) number = new_flow(p, node);
    if (number == -2) return FULL;
    if (number >= 0 && write_flow(p, node, number, written)) return PAUSED;
    int robot = next_member(p, node), kind = INSIDE;
    if (robot < 0) { /* one group */
        if (find_blinded(p, node, of_one, of_one)) return PAUSED;
        number = closing_flow(p, node, node->need);
        if (number >= 0 && write_flow(p, node, number, of_one)) return PAUSED;
        if (p->out->limit >= 0 && write_blinded(p, node, node->need, of_one) && cost_of_group(p, node, node->need) >= 0) {
            if (p->out->n_listed == p->out->most_listed) return FULL;
            for (int i = 0; i < p->robots; i++) p->out->listed[p->out->n_listed * p->robots + i] = (int8_t)IS_INSIDE(node->state[i]);
            p->out->needs[p->out->n_listed++] = least_blinded(p, node);
            write_node(p, LISTED, 0);
            return PAUSED;
        }
        robot = node->most > count_sure(p, node) ? weakest_inside(p, node) : -1, kind = SENSE;
    }
    if (robot < 0) return OPEN;
    write_node(p, kind, robot);
    copy_node(s, node, other);
    if (kind == SENSE) other->state[robot] = SENSES, node->state[robot] &= ~SENSES;
    else other->state[robot] &= ~OUTSIDE, node->state[robot] = OUTSIDE;
    if (other->state[robot] == SENSES) {
        add_information(s->q.team, other->sums, 1.0, robot, other->sums);
        other->found = 1;
    }
    s->depth += 2;
    return PAUSED;
}

int grow_sets_tree(Search *s, GroupTree *out, const int8_t *among, Row rows[], int32_t *depth, int64_t size, int64_t effort) {
    Proof p = {.s = s, .robots = s->robots, .out = out, .by_limits = out->n_limits > 0};
    if (*depth < 0) {
        memcpy(s->sums, s->q.team->prior, (size_t)s->width * sizeof(double));
        int count = 0;
        for (int i = 0; i < s->robots; i++)
            if (among[i]) s->order[count++] = i;
        open_row(&p, rows, *depth = 0, count, (int)size, 0);
    }
    return write_sets(&p, rows, depth, effort);
}

int grow_group_tree(Search *s, GroupTree *out, int64_t cases) {
    size_t n = (size_t)s->robots;
    Proof p = {.s = s, .robots = s->robots, .arcs = (int)s->q.start[n], .out = out};
    p.gains = malloc(2 * n * sizeof(int64_t)), p.seen = malloc(n), p.queue = malloc(n * sizeof(int));
    p.rows = malloc((n + 1) * sizeof(Row));
    int code = p.gains && p.seen && p.queue && p.rows ? PAUSED : FULL;
    if (code == PAUSED && out->count == 0) {
        Node *node = begin(s);
        node->low = 0, node->found = 1, node->cut = 0;
        s->depth = 1;
    }
    int64_t stop = s->visited + cases;
    while (code == PAUSED && s->depth > 0 && s->visited < stop) code = out->count + 4 * (int64_t)n + 12 > out->capacity ? FULL : expand(&p);
    free(p.gains), free(p.seen), free(p.queue), free(p.rows);
    return code == PAUSED && s->depth == 0 ? FINISHED : code;
}
