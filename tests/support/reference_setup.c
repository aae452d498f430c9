/* From the arrays that Python fills to the model.  Included by reference_steps.c. */

#define COARSE 1e-7
#define COARSE_ROWS 5
#define SURFACE_COLUMNS 12

static void *blocks[64];
static int allocated;

static void *get(size_t size)
{
    return blocks[allocated++] = calloc(1, size + 16);
}

static void set_asperites(Model *m, const Scene *scene)
{
    m->a = get(sizeof(Asperite) * scene->n);
    for (int i = 0; i < scene->n; i++) {
        const double *v = scene->asperites + 22 * i;
        Asperite *a = m->a + i;
        a->m1 = v[0], a->m2 = v[1], a->kappa = v[2], a->length = v[3], a->bar_length = v[4];
        a->i2 = v[5], a->charge = v[6], a->facing = v[7], a->clamped = (int)v[8];
        a->surface = (int)v[9], a->stiff = isinf(v[2]);
        a->driven = (int)scene->surface[SURFACE_COLUMNS * a->surface + 2] == BARS;
        if (a->stiff)
            a->kappa = 0; /* energy and torque are not those of a spring */
        a->M = a->m1 + a->m2, a->l1 = a->length * a->m2 / a->M, a->l2 = a->length * a->m1 / a->M;
        a->I = a->m1 * a->l1 * a->l1 + a->m2 * a->l2 * a->l2;
        a->x0 = (real)v[10] + v[11], a->z = (real)v[14] + v[15];
        a->y0 = (real)v[12] + v[13] + a->facing * a->l1;
        a->swing0 = (real)v[16] + v[17];
        a->phi0 = v[18], a->omega0 = v[19], a->nu0 = v[20];
        a->twist0 = a->swing0 - a->phi0;
        a->vx0 = scene->surface[SURFACE_COLUMNS * a->surface];
        a->vy0 = scene->surface[SURFACE_COLUMNS * a->surface + 1];
    }
}

static void set_surfaces(Model *m, const Scene *scene)
{
    m->s = get(sizeof(Surface) * scene->surfaces);
    for (int k = 0; k < scene->surfaces; k++) {
        const double *v = scene->surface + SURFACE_COLUMNS * k;
        Surface *s = m->s + k;
        s->vx = v[0], s->vy = v[1], s->drive = (int)v[2], s->stiffness = v[3], s->speed = v[4];
        s->loaded = (int)v[5], s->load = v[6], s->gamma = v[7], s->ux = v[8], s->uy = v[9];
        s->start = k ? s[-1].stop : 0, s->stop = s->start + (int)v[10];
        s->damping = v[11];
        for (int i = s->start; i < s->stop; i++)
            s->mass += m->a[i].M;
        s->total_mass = s->mass;
    }
    for (int k = 0; k < m->oscillators; k++)
        m->s[m->a[m->osc[k].owner].surface].total_mass += m->osc[k].size;
}

static void set_terms(Model *m, const Scene *scene)
{
    m->term = get(sizeof(Term) * (scene->terms + 1));
    for (int k = 0; k < scene->terms; k++) {
        const double *v = scene->term + 11 * k;
        Term *term = m->term + k;
        term->kind = (int)v[0], term->mode = (int)v[1], term->charged = (int)v[2];
        for (int i = 0; i < 4; i++)
            term->p[i] = v[3 + i];
        term->factor = v[7], term->cutoff = v[8], term->from = v[9];
        term->end = term->mode ? term->cutoff : (real)1e300;
        if (term->kind == WCA) {
            real end = term->p[1] * FN(pow)(2, (real)1 / 6);
            if (end < term->end)
                term->end = end;
        }
        if (term->mode && !(term->kind == WCA && term->end < term->cutoff))
            plain(term, term->cutoff, &term->at_cutoff, &term->slope_at_cutoff);
    }
}

/* Fields, springs and oscillators of both kinds. */
static void set_others(Model *m, const Scene *scene)
{
    m->field = get(sizeof(Field) * (scene->fields + 1));
    for (int k = 0; k < scene->fields; k++) {
        const double *v = scene->field + 5 * k;
        m->field[k] = (Field){2 * PI / v[1], v[0], v[2], v[3], (int)v[4]};
    }
    m->spring = get(sizeof(Spring) * (scene->springs + 1));
    for (int k = 0; k < scene->springs; k++) {
        const double *v = scene->spring + 4 * k;
        const Asperite *a = m->a + (int)v[0], *b = m->a + (int)v[1];
        real x = a->x0 - b->x0, y = a->y0 - b->y0; /* of the centres of mass */
        real rest_y = y + a->facing * (a->l2 - b->l2), c = FN(cos)(v[3]), s = FN(sin)(v[3]);
        m->spring[k] = (Spring){(int)v[0], (int)v[1], v[2], x - (c * x - s * rest_y),
                                y - (s * x + c * rest_y)};
    }
    m->osc = get(sizeof(Oscillator) * (scene->oscillators + 1));
    m->tor = get(sizeof(Oscillator) * (scene->torsionals + 1));
    for (int k = 0; k < scene->oscillators + scene->torsionals; k++) {
        int plane = k < scene->oscillators;
        const double *v = plane ? scene->oscillator + 3 * k
                                : scene->torsional + 3 * (k - scene->oscillators);
        Oscillator o = {(int)v[0], v[1], (real)v[1] * v[2] * v[2]};
        if (plane)
            m->osc[k] = o;
        else
            m->tor[k - scene->oscillators] = o;
    }
}

static void watch(Model *m, int pair, int term, real at)
{
    const Pair *p = m->pair + pair;
    int inside = p->r < at;
    if (FN(fabs)(p->r - at) <= 1e-15 * (double)at)
        inside = p->rate < 0;
    m->watch[m->watches++] = (Watch){pair, term, inside, at};
}

/* Pairs, and the distances at which their formulas change.  Returns whether two bobs coincide. */
static int set_pairs(Model *m, const Scene *scene)
{
    m->pair = get(sizeof(Pair) * (scene->pairs + 1));
    m->watch = get(sizeof(Watch) * (2 * scene->pairs * scene->terms + 1));
    for (int k = 0; k < scene->pairs; k++) {
        const double *v = scene->pair + 5 * k;
        const Asperite *a = m->a + (int)v[0], *b = m->a + (int)v[1];
        m->pair[k] = (Pair){.i = (int)v[0], .j = (int)v[1], .first = (int)v[2], .last = (int)v[3]};
        m->pair[k].within = (int)v[4], m->pair[k].qq = a->charge * b->charge;
        m->pair[k].x0 = a->x0 - b->x0, m->pair[k].y0 = a->y0 - b->y0;
        m->pair[k].z0 = a->z - b->z;
    }
    real y[m->size];
    memset(y, 0, sizeof y);
    move(m, 0, y);
    separate(m, 0);
    for (int k = 0; k < m->pairs; k++) {
        Pair *p = m->pair + k;
        if (p->r == 0 && p->first < p->last)
            return 1;
        for (int c = p->first; c < p->last; c++) {
            if (m->term[c].mode == SWITCH && m->term[c].from < m->term[c].end)
                watch(m, k, c, m->term[c].from);
            if (m->term[c].end < 1e300)
                watch(m, k, c, m->term[c].end);
        }
    }
    return 0;
}

static void set_kinds(Model *m)
{
    m->kind = get(m->size);
    for (int i = 0; i < m->size; i++) {
        int slot = i % WIDTH, kind = ENERGIES;
        if (i >= m->blocks)
            kind = ENERGIES;
        else if (i >= m->torsion)
            kind = (i - m->torsion) % 2 ? RATES : ANGLES;
        else if (i >= m->bath)
            kind = (i - m->bath) % 4 < 2 ? PLACES : SPEEDS;
        else if (slot < WORK)
            kind = (int[]){ANGLES, ANGLES, PLACES, PLACES, RATES, RATES, SPEEDS, SPEEDS}[slot];
        m->kind[i] = (signed char)kind;
    }
}

static int set_model(Model *m, const Scene *scene, double most)
{
    memset(m, 0, sizeof *m);
    m->n = scene->n, m->surfaces = scene->surfaces, m->pairs = scene->pairs;
    m->terms = scene->terms, m->fields = scene->fields, m->springs = scene->springs;
    m->oscillators = scene->oscillators, m->torsionals = scene->torsionals;
    m->box_x = scene->box_x, m->box_z = scene->box_z, m->most = most, m->smallest = 1e300;
    m->bath = WIDTH * m->n, m->torsion = m->bath + 4 * m->oscillators;
    m->blocks = m->torsion + 2 * m->torsionals, m->size = m->blocks + 2 * m->surfaces + 1;
    set_asperites(m, scene);
    set_others(m, scene);
    set_surfaces(m, scene);
    set_terms(m, scene);
    set_kinds(m);
    return set_pairs(m, scene);
}

static void set_work(Work *w, int size, int watches)
{
    real **vectors[] = {&w->start_rate, &w->z, &w->other, &w->rate, &w->sum, &w->carry, &w->best,
                        &w->error};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
        *vectors[k] = get(sizeof(real) * (size + KINDS));
    for (int k = 0; k < ROWS; k++)
        w->table[k] = get(sizeof(real) * size);
    w->distance = get(sizeof(real) * (NODES + 1) * (watches + 1));
}

/* One run; `top` has the scales of the kinds, which grow with the motion. */
static int run(const Scene *scene, int count, const double *times, double tol, int rows,
               double most, real *top, double *out, Info *info)
{
    Model m;
    Work w;
    allocated = 0;
    int status = set_model(&m, scene, most) ? COINCIDENT : DONE;
    set_work(&w, m.size, m.watches);
    int width = m.n * QUANTITIES + 4 * m.surfaces + 3;
    real *y = get(sizeof(real) * m.size), *first = get(sizeof(real) * width), t = 0;
    real h = 1e-6 * times[count - 1];
    memset(info, 0, sizeof *info);
    for (int k = 0; k < count && status == DONE; k++) {
        status = run_to(&m, &w, &t, times[k], y, &h, top, rows, tol, info);
        if (status == DONE && !record(&m, t, y, first, out + (size_t)k * width))
            status = NOT_FINITE;
    }
    info->evaluations = m.evaluations, info->t = (double)t;
    info->smallest = (double)m.smallest, info->smallest_at = (double)m.smallest_at;
    blocks[allocated] = NULL;
    free_all(blocks);
    return status;
}

/* Solves a scene; `out` has a row for each recorded time, of which the first is 0.  A coarse run
   measures the scales that the tolerance of the second is relative to. */
int solve(const Scene *scene, int count, const double *times, double tol, int rows, double most,
          double *out, Info *info)
{
    real top[KINDS] = {0};
    int status = run(scene, count, times, COARSE, COARSE_ROWS, most, top, out, info);
    if (status == DONE)
        status = run(scene, count, times, tol, rows, most, top, out, info);
    return status;
}
