/* Which elements tell at least as much as others, as far as floats can tell. */
#include "planar.h"

enum { NO, OPEN, YES };

/* Whether element `more` dominates `less`: (rows, 3) entries a, b, c of [[a, b], [b, c]]; of equal ones none does, then
   *same is 1. Products that differ by less than `roundings` of them, or are below `smallest`, leave it open. */
static int compare(const double *more, const double *less, int64_t rows, double roundings, double smallest, int *same) {
    int answer = YES;
    *same = 1;
    for (int64_t k = 0; k < 3 * rows; k += 3) {
        double a = more[k] - less[k], b = more[k + 1] - less[k + 1], c = more[k + 2] - less[k + 2];
        double product = a * c, square = b * b;
        if (a != 0.0 || b != 0.0 || c != 0.0) *same = 0;
        if (a < 0.0 || c < 0.0 || (product < square * (1 - roundings) && square > smallest)) {
            *same = 0;
            return NO;
        }
        if (b != 0.0 && !(product > square * (1 + roundings) && square > smallest)) answer = OPEN;
    }
    return answer;
}

void compare_elements(const double *entries, int64_t count, int64_t rows, double roundings, double smallest, int8_t *found) {
    for (int64_t f = 0; f < count; f++)
        for (int64_t e = 0; e < count; e++) {
            int same = 0, answer = NO;
            if (e != f) answer = compare(entries + 3 * f * rows, entries + 3 * e * rows, rows, roundings, smallest, &same);
            found[f * count + e] = (int8_t)(same && f > e ? NO : answer);
        }
}
