/* The equations of motion of a scene and their solution by extrapolation, in long double or, with
   -DQUAD, in __float128.  reference.py describes the arrays, fills them and reads them.

   The state holds departures from free flight: every angle and place less its uniform motion, so
   that weak forces keep all their digits.  Positions enter as differences of the initial ones. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef QUAD
#include <quadmath.h>
typedef __float128 real;
#define FN(name) name##q
#define PI M_PIq
#define ROUNDING 2e-34Q
#else
typedef long double real;
#define FN(name) name##l
#define PI 3.14159265358979323846264338327950288L
#define ROUNDING 1.1e-19L
#endif

/* Slots of an asperite: departures, their rates, works and pseudoworks of 7 forces, heat. */
enum { SWING, PHI, X, Y, OMEGA, NU, VX, VY, WORK, PSEUDO = WORK + 7, HEAT = PSEUDO + 7, WIDTH };
enum { F1, F2, FL, FR, INT, FIELD, THERMAL };
enum { FORCED, FREE, RIGID, PULLED, BARS };
enum { COULOMB, MORSE, LENNARD_JONES, YUKAWA, BUCKINGHAM, BORN_MAYER, WCA, MIE, PLUMMER };
enum { NO_CUTOFF, SWITCH, TRUNCATE, SHIFT, FORCE_SHIFT };
enum { DONE, TOO_COSTLY, UNDERFLOW_OF_STEP, NOT_FINITE, COINCIDENT };
enum { ANGLES, PLACES, RATES, SPEEDS, ENERGIES, KINDS };
#define ROWS 16
#define NODES (2 * ROWS)
#define QUANTITIES 45 /* of an asperite, in the order of report() */

typedef struct {
    int n, surfaces, pairs, terms, fields, springs, oscillators, torsionals;
    const double *asperites, *surface, *pair, *term, *field, *spring, *oscillator, *torsional;
    double box_x, box_z;
} Scene;

typedef struct {
    real m1, m2, M, I, l1, l2, kappa, length, bar_length, i2, charge, facing, swing0, phi0, omega0;
    real nu0, x0, y0, z, vx0, vy0, twist0;
    int surface, clamped, stiff, driven; /* stiff: the pendulum does not swing */
    real damping;                        /* torque on the swing, per omega */
    /* the motion and the forces at one time */
    real swing, phi, dx, dy, omega, nu, dvx, dvy, twist, vx, vy;
    real a1x, a1y, a2x, a2y, v1x, v1y, v2x, v2y, rx, ry;
    real f1x, f1y, f2x, f2y, inx, iny, wix, wiy, fdx, fdy, ftx, fty, turn, torque_T;
    real flx, fly; /* of the left end; that of the right end is opposite */
} Asperite;
typedef struct {
    real vx, vy, stiffness, speed, load, gamma, ux, uy, mass, total_mass, damping;
    int drive, loaded, start, stop;
} Surface;
typedef struct {
    int i, j, first, last, within;
    real x0, y0, z0, qq;
    real dx, dy, r, rate;
} Pair;
typedef struct {
    int kind, mode, charged;
    real p[4], factor, cutoff, from, end, at_cutoff, slope_at_cutoff;
} Term;
typedef struct { int pair, term, inside; real at; } Watch;
typedef struct { real q, amplitude, x0, vx; int surface; } Field;
typedef struct { int i, j; real k, x0, y0; } Spring;
typedef struct { int owner; real size, k; } Oscillator;

typedef struct {
    int n, surfaces, pairs, terms, fields, springs, oscillators, torsionals, watches, size;
    int bath, torsion, blocks; /* first slots */
    Asperite *a;
    Surface *s;
    Pair *pair;
    Term *term;
    Field *field;
    Spring *spring;
    Oscillator *osc, *tor;
    Watch *watch;
    real box_x, box_z;
    signed char *kind; /* of each component */
    double evaluations, most;
    real smallest, smallest_at;
} Model;

static real square(real x) { return x * x; }

/* --- potentials --------------------------------------------------------------------------- */

static void plain(const Term *term, real r, real *u, real *slope)
{
    const real *p = term->p;
    real e, f, s;
    switch (term->kind) {
    case COULOMB:
        *u = p[0] / r, *slope = -p[0] / (r * r);
        break;
    case MORSE:
        e = FN(exp)(-p[1] * (r - p[2]));
        *u = p[0] * (e * e - 2 * e), *slope = -2 * p[1] * p[0] * (e * e - e);
        break;
    case LENNARD_JONES:
    case WCA:
        s = square(p[1] / r), s = s * s * s;
        *u = 4 * p[0] * (s * s - s), *slope = -24 * p[0] * (2 * s * s - s) / r;
        if (term->kind == WCA)
            *u += p[0];
        break;
    case YUKAWA:
        e = p[0] * FN(exp)(-p[1] * r) / r;
        *u = e, *slope = -e * (p[1] + 1 / r);
        break;
    case BUCKINGHAM:
        e = p[0] * FN(exp)(-r / p[1]), s = r * r * r, f = p[2] / (s * s);
        *u = e - f, *slope = -e / p[1] + 6 * f / r;
        break;
    case BORN_MAYER:
        e = p[0] * FN(exp)(-r / p[1]);
        *u = e, *slope = -e / p[1];
        break;
    case MIE:
        s = p[0] * p[2] / (p[2] - p[3]) * FN(pow)(p[2] / p[3], p[3] / (p[2] - p[3]));
        e = s * FN(pow)(p[1] / r, p[2]), f = s * FN(pow)(p[1] / r, p[3]);
        *u = e - f, *slope = -(p[2] * e - p[3] * f) / r;
        break;
    default: /* PLUMMER */
        s = r * r + p[1] * p[1];
        *u = p[0] / FN(sqrt)(s), *slope = -p[0] * r / (s * FN(sqrt)(s));
    }
}

/* U and dU/dr with the cutoff; `inside` counts the breaks of the term beyond r. */
static void potential(const Term *term, real r, int past_from, int past_end, real *u, real *slope)
{
    *u = *slope = 0;
    if (past_end)
        return;
    plain(term, r, u, slope);
    if (term->mode == SHIFT)
        *u -= term->at_cutoff;
    if (term->mode == FORCE_SHIFT) {
        *u -= term->at_cutoff + (r - term->cutoff) * term->slope_at_cutoff;
        *slope -= term->slope_at_cutoff;
    }
    if (term->mode == SWITCH && past_from) {
        real w = term->cutoff - term->from, x = (r - term->from) / w;
        real s = 1 - x * x * x * (10 - x * (15 - 6 * x)), ds = -30 * x * x * (1 - x) * (1 - x) / w;
        *slope = *slope * s + *u * ds;
        *u *= s;
    }
    *u *= term->factor, *slope *= term->factor;
}

/* --- motion and forces -------------------------------------------------------------------- */

/* The centre of mass of an asperite whose bar moves uniformly from its place for theta at rest. */
static void hang_from_bar(Asperite *a)
{
    real half = a->swing / 2, chord = 2 * a->facing * a->l2 * FN(sin)(half);
    a->dx = chord * FN(cos)(half), a->dy = chord * FN(sin)(half);
    a->dvx = a->omega * a->a2y, a->dvy = -a->omega * a->a2x;
    a->vx = a->vx0 + a->dvx, a->vy = a->vy0 + a->dvy;
}

static void move(Model *m, real t, const real *y)
{
    for (int i = 0; i < m->n; i++) {
        Asperite *a = m->a + i;
        const real *q = y + i * WIDTH;
        real turned = a->omega0 * t + q[SWING], s, c;
        a->swing = a->swing0 + turned, a->phi = a->phi0 + a->nu0 * t + q[PHI];
        a->twist = a->twist0 + (turned - a->nu0 * t - q[PHI]);
        a->dx = q[X], a->dy = q[Y], a->dvx = q[VX], a->dvy = q[VY];
        a->omega = a->omega0 + q[OMEGA], a->nu = a->nu0 + q[NU];
        a->vx = a->vx0 + q[VX], a->vy = a->vy0 + q[VY];
        s = a->facing * FN(sin)(a->swing), c = a->facing * FN(cos)(a->swing);
        a->a1x = a->l1 * s, a->a1y = -a->l1 * c, a->a2x = -a->l2 * s, a->a2y = a->l2 * c;
        if (a->driven)
            hang_from_bar(a);
        a->v1x = a->vx - a->omega * a->a1y, a->v1y = a->vy + a->omega * a->a1x;
        a->v2x = a->vx - a->omega * a->a2y, a->v2y = a->vy + a->omega * a->a2x;
        a->rx = a->bar_length / 2 * FN(cos)(a->phi), a->ry = a->bar_length / 2 * FN(sin)(a->phi);
    }
}

static real nearest(real d, real box) { return box > 0 ? d - box * FN(rint)(d / box) : d; }

static void separate(Model *m, real t)
{
    for (int k = 0; k < m->pairs; k++) {
        Pair *p = m->pair + k;
        const Asperite *a = m->a + p->i, *b = m->a + p->j;
        real dz = nearest(p->z0, m->box_z);
        p->dx = p->x0 + (a->vx0 - b->vx0) * t + (a->dx - b->dx) + (a->a1x - b->a1x);
        p->dy = p->y0 + (a->vy0 - b->vy0) * t + (a->dy - b->dy) + (a->a1y - b->a1y);
        p->dx = nearest(p->dx, m->box_x);
        p->r = FN(sqrt)(p->dx * p->dx + p->dy * p->dy + dz * dz);
        p->rate = (p->dx * (a->v1x - b->v1x) + p->dy * (a->v1y - b->v1y)) / p->r;
        if (p->r < m->smallest)
            m->smallest = p->r, m->smallest_at = t;
    }
}

/* Whether a pair is beyond the start of a term's switch, and beyond its end. */
static void sides(const Model *m, int *past_from, int *past_end)
{
    memset(past_from, 0, sizeof(int) * m->pairs * m->terms);
    memset(past_end, 0, sizeof(int) * m->pairs * m->terms);
    for (int w = 0; w < m->watches; w++) {
        const Watch *watch = m->watch + w;
        const Term *term = m->term + watch->term;
        int slot = watch->pair * m->terms + watch->term;
        if (term->mode == SWITCH && watch->at == term->from)
            past_from[slot] |= !watch->inside;
        else
            past_end[slot] |= !watch->inside;
    }
}

static void contact_forces(Model *m, real t, real *between, real *within)
{
    int from[m->pairs * m->terms + 1], end[m->pairs * m->terms + 1];
    separate(m, t);
    sides(m, from, end);
    for (int k = 0; k < m->pairs; k++) {
        Pair *p = m->pair + k;
        Asperite *a = m->a + p->i, *b = m->a + p->j;
        real pull = 0;
        for (int c = p->first; c < p->last; c++) {
            real u, slope, qq = m->term[c].charged ? p->qq : 1;
            int slot = k * m->terms + c;
            if (end[slot])
                continue;
            potential(m->term + c, p->r, from[slot], end[slot], &u, &slope);
            pull -= qq * slope / p->r;
            if (p->within && within)
                within[a->surface] += qq * u;
            else if (between)
                *between += qq * u;
        }
        if (p->within) {
            a->wix += pull * p->dx, a->wiy += pull * p->dy;
            b->wix -= pull * p->dx, b->wiy -= pull * p->dy;
        } else {
            a->f1x += pull * p->dx, a->f1y += pull * p->dy;
            b->f1x -= pull * p->dx, b->f1y -= pull * p->dy;
        }
    }
}

static real field_forces(Model *m, real t, real *drifting)
{
    real energy = 0;
    *drifting = 0;
    for (int k = 0; k < m->fields; k++) {
        const Field *f = m->field + k;
        for (int i = m->s[f->surface].start; i < m->s[f->surface].stop; i++) {
            Asperite *a = m->a + i;
            real x = f->q * (a->x0 - f->x0 + (a->vx0 - f->vx) * t + a->dx + a->a1x);
            real force = -f->amplitude * f->q * FN(sin)(x);
            a->fdx += force;
            energy -= f->amplitude * FN(cos)(x);
            *drifting += force * f->vx;
        }
    }
    return energy;
}

static void drive_forces(Model *m, real t)
{
    for (int k = 0; k < m->surfaces; k++) {
        const Surface *s = m->s + k;
        real sum = 0;
        for (int i = s->start; i < s->stop; i++)
            sum += m->a[i].f1x;
        for (int i = s->start; i < s->stop; i++) {
            Asperite *a = m->a + i;
            a->f2x = -a->f1x, a->f2y = s->loaded ? -a->facing * s->load : -a->f1y;
            if (s->drive == FREE)
                a->f2x = 0;
            if (s->drive == RIGID)
                a->f2x += a->M / s->mass * sum;
            if (s->drive == PULLED)
                a->f2x = s->stiffness * ((s->speed - a->vx0) * t - a->dx - a->a2x);
            a->ftx = -s->gamma * (a->v2x - s->ux), a->fty = -s->gamma * (a->v2y - s->uy);
            a->torque_T = -s->damping * a->omega;
        }
    }
}

/* Forces of springs and baths on bars; their rates in dy; adds up energies per surface if asked. */
static void inner_forces(Model *m, const real *y, real *dy, real *energy)
{
    for (int k = 0; k < m->springs; k++) {
        const Spring *s = m->spring + k;
        Asperite *a = m->a + s->i, *b = m->a + s->j;
        real x = s->x0 + (a->dx - b->dx) + (a->a2x - b->a2x);
        real z = s->y0 + (a->dy - b->dy) + (a->a2y - b->a2y);
        a->inx -= s->k * x, a->iny -= s->k * z, b->inx += s->k * x, b->iny += s->k * z;
        if (energy)
            energy[a->surface] += s->k * (x * x + z * z) / 2;
    }
    for (int k = 0; k < m->oscillators; k++) {
        const Oscillator *o = m->osc + k;
        Asperite *a = m->a + o->owner;
        const real *q = y + m->bath + 4 * k;
        real half = (a->swing - a->swing0) / 2, mean = a->swing0 + half;
        real chord = 2 * a->facing * a->l2 * FN(sin)(half); /* arm2 less its start */
        real x = -q[0], z = -q[1]; /* driven bars stay where the oscillators start */
        if (!a->driven)
            x += a->dx - chord * FN(cos)(mean), z += a->dy - chord * FN(sin)(mean);
        a->inx -= o->k * x, a->iny -= o->k * z;
        if (dy) {
            real *d = dy + m->bath + 4 * k;
            d[0] = q[2], d[1] = q[3], d[2] = o->k * x / o->size, d[3] = o->k * z / o->size;
        }
        if (energy)
            energy[a->surface] += o->k * (x * x + z * z) / 2
                                  + o->size * (a->vx0 * q[2] + a->vy0 * q[3])
                                  + o->size * (square(q[2]) + square(q[3])) / 2;
    }
    for (int k = 0; k < m->torsionals; k++) {
        const Oscillator *o = m->tor + k;
        Asperite *a = m->a + o->owner;
        const real *q = y + m->torsion + 2 * k;
        real x = a->phi - a->phi0 - q[0];
        a->turn -= o->k * x;
        if (dy)
            dy[m->torsion + 2 * k] = q[1], dy[m->torsion + 2 * k + 1] = o->k * x / o->size;
        if (energy)
            energy[a->surface] += (o->k * x * x + o->size * q[1] * q[1]) / 2;
    }
}

/* V - V0 of each surface, asperites and baths together. */
static void departures_of_velocity(const Model *m, const real *y, real *x, real *z)
{
    for (int k = 0; k < m->surfaces; k++)
        x[k] = z[k] = 0;
    for (int i = 0; i < m->n; i++) {
        const Asperite *a = m->a + i;
        x[a->surface] += a->M * a->dvx, z[a->surface] += a->M * a->dvy;
    }
    for (int k = 0; k < m->oscillators; k++) {
        const real *q = y + m->bath + 4 * k;
        int s = m->a[m->osc[k].owner].surface;
        x[s] += m->osc[k].size * q[2], z[s] += m->osc[k].size * q[3];
    }
    for (int k = 0; k < m->surfaces; k++)
        x[k] /= m->s[k].total_mass, z[k] /= m->s[k].total_mass;
}

static void clear_forces(Model *m)
{
    for (int i = 0; i < m->n; i++) {
        Asperite *a = m->a + i;
        a->f1x = a->f1y = a->f2x = a->f2y = a->inx = a->iny = a->wix = a->wiy = 0;
        a->fdx = a->fdy = a->ftx = a->fty = a->turn = 0;
    }
}

/* f2 that moves the bar uniformly, M r_cm'' less all other forces, and the pendulum's omega'. */
static real reaction(Asperite *a, real bob_x, real bob_y)
{
    real lx = a->a1x - a->a2x, ly = a->a1y - a->a2y, alpha = 0;
    if (!a->stiff)
        alpha = (lx * bob_y - ly * bob_x - a->kappa * a->twist + a->torque_T)
                / (a->m1 * a->length * a->length);
    real ax = alpha * a->a2y + square(a->omega) * a->a2x;
    real ay = -alpha * a->a2x + square(a->omega) * a->a2y;
    a->f2x = a->M * ax - bob_x - a->inx, a->f2y = a->M * ay - bob_y - a->iny;
    return alpha;
}

/* The rates of one asperite: accelerations, powers and pseudopowers. */
static real asperite_rates(Asperite *a, const Surface *s, real *d, real *external)
{
    real bob_x = a->f1x + a->fdx + a->wix, bob_y = a->f1y + a->fdy + a->wiy, alpha = 0;
    if (a->driven)
        alpha = reaction(a, bob_x, bob_y);
    real bar_x = a->f2x + a->inx + a->ftx, bar_y = a->f2y + a->iny + a->fty;
    real torque = a->a1x * bob_y - a->a1y * bob_x + a->a2x * bar_y - a->a2y * bar_x + a->torque_T;
    real torsion = a->stiff ? torque : a->kappa * a->twist;
    real end = a->clamped ? torsion / a->bar_length : 0;
    a->flx = -end * a->ry / (a->bar_length / 2), a->fly = end * a->rx / (a->bar_length / 2);
    real fx[] = {a->f1x, a->f2x, a->flx, -a->flx, a->inx, a->fdx, a->ftx};
    real fy[] = {a->f1y, a->f2y, a->fly, -a->fly, a->iny, a->fdy, a->fty};
    d[SWING] = a->omega - a->omega0, d[PHI] = a->nu - a->nu0, d[X] = a->dvx, d[Y] = a->dvy;
    d[OMEGA] = a->driven ? alpha : (torque - torsion) / a->I;
    d[NU] = a->clamped ? 0 : (torsion + a->turn) / a->i2;
    d[VX] = (bob_x + bar_x) / a->M, d[VY] = (bob_y + bar_y) / a->M;
    if (a->driven) /* places and velocities follow from the angle: see move() */
        d[X] = d[Y] = d[VX] = d[VY] = 0;
    for (int f = 0; f < 7; f++) {
        real vx = a->v2x, vy = a->v2y;
        if (f == F1 || f == FIELD)
            vx = a->v1x, vy = a->v1y;
        if (f == FL)
            vx += a->nu * a->ry, vy -= a->nu * a->rx;
        if (f == FR)
            vx -= a->nu * a->ry, vy += a->nu * a->rx;
        d[WORK + f] = fx[f] * vx + fy[f] * vy;
        d[PSEUDO + f] = fx[f] * a->vx + fy[f] * a->vy;
    }
    d[WORK + INT] += a->wix * a->v1x + a->wiy * a->v1y + a->turn * a->nu;
    d[PSEUDO + INT] += a->wix * a->vx + a->wiy * a->vy;
    d[WORK + THERMAL] += a->torque_T * a->omega;
    d[HEAT] = -(a->ftx * (a->v2x - s->ux) + a->fty * (a->v2y - s->uy)) - a->torque_T * a->omega;
    external[0] = a->f1x + a->f2x + a->fdx + a->ftx;
    external[1] = a->f1y + a->f2y + a->fdy + a->fty;
    return d[WORK + F2] + d[WORK + FL] + d[WORK + FR] + d[WORK + THERMAL];
}

static void rates(Model *m, real t, const real *y, real *dy)
{
    real vx[m->surfaces], vy[m->surfaces], external[2], drifting;
    move(m, t, y);
    clear_forces(m);
    contact_forces(m, t, NULL, NULL);
    field_forces(m, t, &drifting);
    drive_forces(m, t);
    inner_forces(m, y, dy, NULL);
    departures_of_velocity(m, y, vx, vy);
    real *block = dy + m->blocks, *applied = block + 2 * m->surfaces;
    for (int k = 0; k < 2 * m->surfaces; k++)
        block[k] = 0;
    *applied = drifting;
    for (int i = 0; i < m->n; i++) {
        Asperite *a = m->a + i;
        const Surface *s = m->s + a->surface;
        real *d = dy + i * WIDTH;
        real outside = asperite_rates(a, s, d, external);
        *applied += outside;
        block[2 * a->surface] += outside + d[WORK + F1] + d[WORK + FIELD];
        block[2 * a->surface + 1] += external[0] * (s->vx + vx[a->surface])
                                     + external[1] * (s->vy + vy[a->surface]);
    }
    m->evaluations++;
}

/* --- what is reported --------------------------------------------------------------------- */

static void report(Model *m, real t, const real *y, real *out)
{
    real stored[m->surfaces], dvx[m->surfaces], dvy[m->surfaces], contact = 0, drifting;
    real change[m->surfaces], rates[WIDTH] = {0}, external[2];
    memset(stored, 0, sizeof stored);
    move(m, t, y);
    clear_forces(m);
    contact_forces(m, t, &contact, stored);
    real field = field_forces(m, t, &drifting);
    drive_forces(m, t);
    inner_forces(m, y, NULL, stored);
    departures_of_velocity(m, y, dvx, dvy);
    memcpy(change, stored, sizeof stored);
    for (int i = 0; i < m->n; i++) {
        Asperite *a = m->a + i;
        const real *q = y + i * WIDTH, *w = q + WORK, *ps = q + PSEUDO;
        real dw = q[OMEGA], dn = q[NU], dt = a->twist - a->twist0, x = a->x0 + a->vx0 * t + a->dx;
        real yc = a->y0 + a->vy0 * t + a->dy, rest = a->facing > 0 ? 0.0 : 3.141592653589793116;
        asperite_rates(a, m->s + a->surface, rates, external);
        real trans = a->M * (a->vx0 * a->dvx + a->vy0 * a->dvy);
        trans += a->M * (a->dvx * a->dvx + a->dvy * a->dvy) / 2;
        real e = a->I * dw * (2 * a->omega0 + dw) + a->i2 * dn * (2 * a->nu0 + dn);
        e = (e + a->kappa * dt * (2 * a->twist0 + dt)) / 2;
        real values[QUANTITIES] = {
            a->swing + rest, a->phi, a->omega, a->nu, x, yc, a->vx, a->vy, x + a->a1x, yc + a->a1y,
            x + a->a2x, yc + a->a2y, w[F1], w[F2], w[FL], w[FR], w[INT], 0, ps[F1], ps[F2], ps[INT],
            0, trans, e, w[FIELD], ps[FIELD], w[THERMAL], ps[THERMAL], q[HEAT],
            a->v1x, a->v1y, a->f1x, a->f1y, a->f2x, a->f2y, a->flx, a->fly, -a->flx, -a->fly, a->wix,
            a->wiy, a->fdx, a->fdy, a->inx, a->iny};
        for (int f = 0; f < 7; f++)
            values[17] += w[f], values[21] += ps[f];
        memcpy(out + i * QUANTITIES, values, sizeof values);
        change[a->surface] += trans + e;
    }
    out += m->n * QUANTITIES;
    real total = contact + field;
    for (int k = 0; k < m->surfaces; k++) {
        const Surface *s = m->s + k;
        real d_k = s->total_mass * (s->vx * dvx[k] + s->vy * dvy[k]);
        d_k += s->total_mass * (dvx[k] * dvx[k] + dvy[k] * dvy[k]) / 2;
        real block[] = {y[m->blocks + 2 * k], y[m->blocks + 2 * k + 1], d_k, change[k] - d_k};
        memcpy(out + 4 * k, block, sizeof block);
        total += change[k];
    }
    out += 4 * m->surfaces;
    out[0] = contact, out[1] = total, out[2] = y[m->blocks + 2 * m->surfaces];
}

#include "reference_steps.c"
