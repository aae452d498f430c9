/* The solution: Gragg's midpoint rule, extrapolated, with steps that end where a formula changes.
   Included by reference.c. */

/* Rounding of an extrapolated change, in units of one rounding: coefficients of up to 50. */
#define AMPLIFIED 100

/* A row stalls if its error exceeds this part of the error of the row before. */
#define STALLED 0.2
/* The largest error, in units of the tolerance, that rounding may explain. */
#define ROUNDED 1e8

typedef struct {
    real *start_rate, *z, *other, *rate, *sum, *carry, *best, *error, *table[ROWS], *distance;
} Work;

typedef struct { double evaluations, steps, smallest, smallest_at, t; } Info;

/* The change of the state in a step by the midpoint rule with `count` substeps. */
static void midpoint(Model *m, Work *w, real t, const real *y, real h, int count, real *result)
{
    real *a = w->z, *b = w->other, part = h / count;
    for (int i = 0; i < m->size; i++)
        a[i] = 0, b[i] = part * w->start_rate[i];
    for (int s = 1; s < count; s++) {
        for (int i = 0; i < m->size; i++)
            w->sum[i] = y[i] + b[i];
        rates(m, t + s * part, w->sum, w->rate);
        for (int k = 0; k < m->watches; k++)
            w->distance[s * m->watches + k] = m->pair[m->watch[k].pair].r;
        for (int i = 0; i < m->size; i++) {
            real next = a[i] + 2 * part * w->rate[i];
            a[i] = b[i], b[i] = next;
        }
    }
    memcpy(result, b, sizeof(real) * m->size);
}

/* The largest difference of two columns, relative to what is allowed: tol times the scale of the
   kind, and the rounding of the change over the step. */
static real error_of(const Model *m, const real *a, const real *b, const real *scale, real tol)
{
    real worst = 0, allowed[KINDS] = {0};
    for (int i = 0; i < m->size; i++)
        allowed[(int)m->kind[i]] = FN(fmax)(allowed[(int)m->kind[i]], FN(fabs)(a[i]));
    for (int k = 0; k < KINDS; k++)
        allowed[k] = AMPLIFIED * ROUNDING * allowed[k] + tol * scale[k];
    for (int i = 0; i < m->size; i++) {
        real e = FN(fabs)(a[i] - b[i]) / allowed[(int)m->kind[i]];
        if (!(e <= worst))
            worst = e;
    }
    return worst;
}

/* Scales of the kinds: the largest departures so far, and the change over the step. */
static void measure(const Model *m, const real *y, const real *z, const real *most, real *scale)
{
    real rod = 0;
    for (int k = 0; k < KINDS; k++)
        scale[k] = most[k];
    for (int i = 0; i < m->size; i++) {
        real v = FN(fabs)(y[i]) + FN(fabs)(z[i]);
        if (v > scale[(int)m->kind[i]])
            scale[(int)m->kind[i]] = v;
    }
    for (int i = 0; i < m->n; i++)
        rod = FN(fmax)(rod, m->a[i].length);
    scale[PLACES] = FN(fmax)(scale[PLACES], rod * scale[ANGLES]);
    scale[SPEEDS] = FN(fmax)(scale[SPEEDS], rod * scale[RATES]);
    scale[ANGLES] = FN(fmax)(scale[ANGLES], scale[PLACES] / rod);
    scale[RATES] = FN(fmax)(scale[RATES], scale[SPEEDS] / rod);
    for (int k = 0; k < KINDS; k++)
        if (scale[k] == 0)
            scale[k] = 1;
}

/* One step: the change in w->best.  Returns the row that was accepted, 0 if none was.  Where the
   rounding of forces is the limit, rows gain nothing: then the last is accepted, and the two
   tolerances differ by that rounding. */
static int extrapolate(Model *m, Work *w, real t, const real *y, real h, int rows, real tol,
                       const real *most, real *error, int full)
{
    real scale[KINDS], before = 0, still = 0;
    for (int j = 0; j < rows; j++) {
        real *next = w->error;
        midpoint(m, w, t, y, h, 2 * (j + 1), next);
        for (int l = 1; l <= j; l++) {
            real ratio = (real)(j + 1) / (j + 1 - l), factor = 1 / (ratio * ratio - 1);
            real *old = w->table[l - 1];
            for (int i = 0; i < m->size; i++) {
                real better = next[i] + (next[i] - old[i]) * factor;
                old[i] = next[i], w->best[i] = better;
            }
            memcpy(next, w->best, sizeof(real) * m->size);
        }
        if (j > 0) {
            measure(m, y, next, most, scale);
            *error = error_of(m, next, w->table[j - 1], scale, tol);
            still = *error > STALLED * before ? still + 1 : 0, before = *error;
        }
        memcpy(w->table[j], next, sizeof(real) * m->size);
        memcpy(w->best, next, sizeof(real) * m->size);
        if (j >= 3 && *error <= 1 && !full)
            return j + 1;
        if (j > 2 && !(*error < 1e60))
            return 0;
    }
    if (*error > 1 && *error < ROUNDED && still > 1)
        *error = 0;
    return *error <= 1 ? rows : 0;
}

/* --- changes of formula -------------------------------------------------------------------- */

enum { CLEAR, CROSSED, UNCLEAR };

/* What the distances at the n substeps say about one watch: 0 clear, 1 crossed once, 2 unclear.
   g > 0 on the own side; `first` and `last` are rates of g at both ends of the step. */
static int look(const real *g, int n, real first, real last, real part)
{
    int signs = 0;
    for (int s = 1; s <= n; s++)
        if (s > 1 ? (g[s] < 0) != (g[s - 1] < 0) : g[s] < 0)
            signs++;
    if (signs > 1 || (signs == 1 && g[n] >= 0))
        return UNCLEAR;
    for (int s = 1; s < n; s++) {
        real rise = FN(fmax)(g[s - 1], g[s + 1]) - g[s];
        if (g[s] >= 0 && g[s] <= g[s - 1] && g[s] <= g[s + 1] && 3 * g[s] < rise)
            return UNCLEAR;
        if (g[s] < 0 && g[s] >= g[s - 1] && g[s] >= g[s + 1])
            return UNCLEAR;
    }
    if (signs == 1)
        return last < 0 ? CROSSED : UNCLEAR;
    if ((first < 0 && g[1] >= g[0] && g[0] < -first * part)
        || (last > 0 && g[n] <= g[n - 1] && g[n] < last * part))
        return UNCLEAR;
    return CLEAR;
}

/* Looks for changes of formula in a step of n substeps: the first watch that is crossed, or -1,
   and the time at which, roughly; -2 if that is unclear. */
static int first_crossing(Model *m, Work *w, const real *start, const real *start_rate, int n,
                          real h, real *when)
{
    int found = -1;
    real g[NODES + 1];
    for (int k = 0; k < m->watches; k++) {
        const Watch *watch = m->watch + k;
        const Pair *p = m->pair + watch->pair;
        real sign = watch->inside ? -1 : 1;
        for (int s = 0; s <= n; s++) {
            real r = s == 0 ? start[k] : s == n ? p->r : w->distance[s * m->watches + k];
            g[s] = sign * (r - watch->at);
        }
        int seen = look(g, n, sign * start_rate[k], sign * p->rate, h / n);
        if (seen == UNCLEAR)
            return -2;
        if (seen == CROSSED) {
            int s = n;
            while (s > 1 && g[s - 1] < 0)
                s--;
            real before = FN(fmax)(g[s - 1], 0), at = h / n * (s - 1 + before / (before - g[s]));
            if (found < 0 || at < *when)
                found = k, *when = at;
        }
    }
    return found;
}

/* Turns every watch that is at its distance and leaves its side. */
static void turn_watches(Model *m, int crossed)
{
    for (int k = 0; k < m->watches; k++) {
        Watch *watch = m->watch + k;
        const Pair *p = m->pair + watch->pair;
        real sign = watch->inside ? -1 : 1, near = 1e6 * (double)ROUNDING * watch->at;
        if (k == crossed || (FN(fabs)(p->r - watch->at) < near && sign * p->rate < 0))
            watch->inside = !watch->inside;
    }
}

/* Shortens a step to end where watch k is crossed; returns its length, the change in w->best. */
static real to_crossing(Model *m, Work *w, real t, const real *y, int k, real when, int rows,
                        const real *most)
{
    real error, at = m->watch[k].at;
    for (int tries = 0; tries < 12; tries++) {
        extrapolate(m, w, t, y, when, rows, 1, most, &error, 1);
        for (int i = 0; i < m->size; i++)
            w->sum[i] = y[i] + w->best[i];
        move(m, t + when, w->sum);
        separate(m, t + when);
        const Pair *p = m->pair + m->watch[k].pair;
        if (FN(fabs)(p->r - at) <= 4 * ROUNDING * at || p->rate == 0)
            break;
        when = FN(fmax)(when - (p->r - at) / p->rate, 0);
    }
    return when;
}

/* --- the run -------------------------------------------------------------------------------- */

/* Phase of the stiffest spring in a step, at most: with a longer one, extrapolation amplifies
   rounding until it is as large as the tolerance of all other motion. */
#define MOST_PHASE 3

/* A bound on the square of the frequency of lattice springs, by Gershgorin. */
static real stiffest(const Model *m)
{
    real on[m->n], most = 0;
    for (int i = 0; i < m->n; i++)
        on[i] = 0;
    for (int k = 0; k < m->springs; k++)
        on[m->spring[k].i] += 2 * m->spring[k].k, on[m->spring[k].j] += 2 * m->spring[k].k;
    for (int i = 0; i < m->n; i++) {
        const Asperite *a = m->a + i;
        most = FN(fmax)(most, on[i] * (1 / a->M + a->l2 * a->l2 / a->I));
    }
    return most;
}

/* The longest step that cannot miss an encounter, from the motion at its start, and that resolves
   the stiffest spring. */
static real longest_step(const Model *m)
{
    real square = stiffest(m), longest = square > 0 ? MOST_PHASE / FN(sqrt)(square) : 1e300;
    for (int k = 0; k < m->pairs; k++) {
        const Pair *p = m->pair + k;
        const Asperite *a = m->a + p->i, *b = m->a + p->j;
        real speed = FN(hypot)(a->v1x - b->v1x, a->v1y - b->v1y), room = p->r;
        if (m->box_x > 0 && room > m->box_x / 4)
            room = m->box_x / 4;
        if (speed > 0)
            longest = FN(fmin)(longest, room * 4 / 5 / speed);
    }
    for (int k = 0; k < m->fields; k++) {
        const Surface *s = m->s + m->field[k].surface;
        for (int i = s->start; i < s->stop; i++) {
            real speed = FN(fabs)(m->a[i].v1x - m->field[k].vx);
            if (speed > 0)
                longest = FN(fmin)(longest, 3 * PI / m->field[k].q / speed);
        }
    }
    return longest;
}

static int record(Model *m, real t, const real *y, real *first, double *out)
{
    int per = m->n * QUANTITIES, total = per + 4 * m->surfaces + 3, good = 1;
    real values[total];
    report(m, t, y, values);
    if (t == 0)
        memcpy(first, values, sizeof values);
    for (int i = 0; i < m->n; i++) /* a pendulum that swings on a driven bar moves r_cm */
        values[QUANTITIES * i + 22] -= first[QUANTITIES * i + 22];
    for (int k = 0; k < m->surfaces; k++)
        for (int i = 2; i < 4; i++)
            values[per + 4 * k + i] -= first[per + 4 * k + i];
    values[total - 2] -= first[total - 2];
    for (int i = 0; i < total; i++) {
        out[i] = (double)values[i];
        good &= isfinite(out[i]) != 0;
    }
    return good;
}

/* Adds the change in w->best to the state, with the rounding that the last sums left. */
static void advance(const Model *m, Work *w, real *y, real *most)
{
    for (int i = 0; i < m->size; i++) {
        real change = w->best[i] + w->carry[i], sum = y[i] + change;
        w->carry[i] = change - (sum - y[i]);
        y[i] = sum;
    }
    measure(m, y, w->carry, most, w->sum);
    for (int k = 0; k < KINDS; k++)
        if (!(w->sum[k] == 1 && most[k] == 0))
            most[k] = w->sum[k];
}

/* From t to the next recorded time. */
static int run_to(Model *m, Work *w, real *t, real end, real *y, real *h, real *most, int rows,
                  real tol, Info *info)
{
    real start[m->watches + 1], start_rate[m->watches + 1];
    while (*t < end) {
        if (m->evaluations > m->most)
            return TOO_COSTLY;
        rates(m, *t, y, w->start_rate);
        for (int k = 0; k < m->watches; k++) {
            start[k] = m->pair[m->watch[k].pair].r, start_rate[k] = m->pair[m->watch[k].pair].rate;
            start[k] = m->watch[k].inside ? FN(fmin)(start[k], m->watch[k].at)
                                          : FN(fmax)(start[k], m->watch[k].at);
        }
        real wanted = FN(fmin)(*h, longest_step(m)), error = 0, when = 0;
        int last = wanted >= end - *t, row, crossed = -1;
        real step = last ? end - *t : wanted;
        if (!(step > 4 * ROUNDING * *t))
            return isfinite((double)step) ? UNDERFLOW_OF_STEP : NOT_FINITE;
        row = extrapolate(m, w, *t, y, step, rows, tol, most, &error, 0);
        info->steps++;
        real factor = error > 0 ? FN(pow)(1 / error, (real)1 / (2 * (row ? row : rows) - 1)) : 4;
        if (row == 0) {
            *h = step * (error > 0 ? FN(fmax)(0.1, FN(fmin)(0.7, factor * 0.8)) : 0.1);
            continue;
        }
        if (m->watches) {
            for (int i = 0; i < m->size; i++)
                w->sum[i] = y[i] + w->best[i];
            move(m, *t + step, w->sum);
            separate(m, *t + step);
            crossed = first_crossing(m, w, start, start_rate, 2 * row, step, &when);
            if (crossed == -2 && step > 1e-12 * (double)end) {
                *h = step / 2;
                continue;
            }
            if (crossed >= 0)
                step = to_crossing(m, w, *t, y, crossed, when, rows, most), last = 0;
        }
        advance(m, w, y, most);
        *t = last ? end : *t + step;
        if (crossed >= 0)
            turn_watches(m, crossed);
        real grown = row <= rows - 2 ? 2 : FN(fmax)(0.3, FN(fmin)(1.5, 0.8 * factor));
        real next = step * grown;
        *h = crossed >= 0 || step < wanted || wanted < *h ? FN(fmax)(*h, next) : next;
    }
    return DONE;
}

static void free_all(void **blocks)
{
    for (; *blocks; blocks++)
        free(*blocks);
}

#include "reference_setup.c"
