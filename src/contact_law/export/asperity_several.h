/* The update of several contacts. No guard: included once. */

/* The increment of one contact of several. `next` may be `state`. */
typedef struct asperity_increment {
    const asperity_state *state;
    asperity_state *next;
    asperity_real radius, h, d[2];
    asperity_response out;
} asperity_increment;

#if ASPERITY_WIDTH > 1
/* Puts memories into lanes, and takes them from there: the numbers of both stand in the same order. */
ASPERITY_FN void asperity_load(const asperity_state *const from[ASPERITY_WIDTH], asperity_wide_work *to) {
    asperity_wide_v *at = &to->h;
    int i, k;
#ifdef ASPERITY_TRANSPOSES
    for (i = 0; i < ASPERITY_NUMBERS; i += 8) {
        const int count = ASPERITY_NUMBERS - i < 8 ? ASPERITY_NUMBERS - i : 8;
        __m512d x[8];
        for (k = 0; k < 8; k++) {
            x[k] = _mm512_maskz_loadu_pd((__mmask8)((1 << count) - 1), &from[k]->h + i);
        }
        asperity_transpose(x);
        for (k = 0; k < count; k++) {
            at[i + k] = (asperity_wide_v)x[k];
        }
    }
#else
    for (k = 0; k < ASPERITY_WIDTH; k++) {
        const asperity_real *numbers = &from[k]->h;
        for (i = 0; i < ASPERITY_NUMBERS; i++) {
            at[i][k] = (double)numbers[i];
        }
    }
#endif
}

ASPERITY_FN void asperity_unload(const asperity_wide_work *from, asperity_state *const to[ASPERITY_WIDTH]) {
    const asperity_wide_v *at = &from->h;
    int i, k;
#ifdef ASPERITY_TRANSPOSES
    for (i = 0; i < ASPERITY_NUMBERS; i += 8) {
        const int count = ASPERITY_NUMBERS - i < 8 ? ASPERITY_NUMBERS - i : 8;
        __m512d x[8];
        for (k = 0; k < 8; k++) {
            x[k] = (__m512d)at[i + (k < count ? k : 0)];
        }
        asperity_transpose(x);
        for (k = 0; k < 8; k++) {
            if (to[k]) {
                _mm512_mask_storeu_pd(&to[k]->h + i, (__mmask8)((1 << count) - 1), x[k]);
            }
        }
    }
#else
    for (k = 0; k < ASPERITY_WIDTH; k++) {
        asperity_real *numbers = to[k] ? &to[k]->h : NULL;
        for (i = 0; numbers && i < ASPERITY_NUMBERS; i++) {
            numbers[i] = ASPERITY_R(at[i][k]);
        }
        if (numbers) {
            asperity_round_down(&to[k]->hardened, from->hardened[k]);
        }
    }
#endif
}

/* Of which contacts the memory is one that the update may have left: see asperity_is_sound(). */
ASPERITY_FN asperity_wide_m asperity_are_sound(const asperity_wide_work *s) {
    asperity_wide_v sum = s->vertex[0] + s->vertex[1] + s->hint[0] + s->hint[1] + s->hint[2], others = s->h_max + s->hardened + s->reach + s->softened + s->released + s->worn + s->stiffened;
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        sum += s->slider[0][i] + s->slider[1][i] + s->slider[2][i];
    }
    return asperity_wide_are_finite(s->h) & asperity_wide_are_finite(s->approach) & asperity_wide_are_finite(sum) & asperity_wide_are_finite(others) & (s->h_max >= 0.0) &
           (s->hardened >= 0.0) & (s->reach >= 0.0) & (s->softened >= 0.0) & (s->softened < 1.0) & (s->released >= 0.0) & (s->released <= 1.0) & (s->worn >= 0.0) & (s->worn <= 2.0) &
           (s->stiffened >= 0.0);
}

/* Contacts that wait for their lanes. */
typedef struct asperity_queue {
    asperity_increment *one[2 * ASPERITY_WIDTH]; /* those of a second group come behind the first */
    asperity_entry by[2 * ASPERITY_WIDTH];
    int count;
} asperity_queue;

/* Moves the first of those that wait, side by side; where `what` is ASPERITY_ELASTIC, those that yield go into the queue `yields`, which has room. */
ASPERITY_FN void asperity_advance_wide(const asperity_table *t, asperity_real modulus, int what, asperity_queue *queue, asperity_queue *yields) {
    asperity_increment *const *which = queue->one;
    const asperity_entry *by = queue->by;
    const int count = queue->count < ASPERITY_WIDTH ? queue->count : ASPERITY_WIDTH;
    const asperity_state *before[ASPERITY_WIDTH];
    asperity_state *next[ASPERITY_WIDTH];
    asperity_wide_work s, after;
    asperity_wide_step first;
    asperity_wide_guess o;
    asperity_wide_account a;
    asperity_wide_v h = asperity_wide_all(0.0), d[2], radius = h, force, work;
    asperity_wide_m found, sound;
    int k;
    d[0] = d[1] = h;
    for (k = 0; k < ASPERITY_WIDTH; k++) {
        const int from = k < count ? k : 0; /* who is missing is stood in for */
        before[k] = which[from]->state;
        h[k] = by[from].h;
        d[0][k] = by[from].d[0];
        d[1][k] = by[from].d[1];
        radius[k] = (double)which[from]->radius;
    }
    asperity_load(before, &s);
    sound = asperity_are_sound(&s);
    found = sound & asperity_wide_move(t, &s, NULL, h, d, what, &first, &after, &o);
    a.total = a.slip = a.unsolved = asperity_wide_all(0.0);
    asperity_wide_account_for(&first, &o, &a);
    found &= asperity_wide_are_finite(a.stored) & asperity_wide_are_finite(a.f_n + a.f_t[0] + a.f_t[1]);
    /* In the user's units, as asperity_answer() has them. */
    force = (double)modulus * radius * radius;
    work = force * radius;
    a.total = (a.total - a.slip) * work;
    a.slip *= work;
    a.f_n *= force;
    a.f_t[0] *= force;
    a.f_t[1] *= force;
    a.stored *= work;
    a.stiffness *= (double)modulus * radius;
    for (k = 0; k < ASPERITY_WIDTH; k++) {
        next[k] = k < count && found[k] ? which[k]->next : NULL;
    }
    for (k = 0; k < count; k++) {
        asperity_increment *one = which[k];
        if (next[k]) {
            one->out.f_n = ASPERITY_R(a.f_n[k]);
            one->out.f_t[0] = ASPERITY_R(a.f_t[0][k]);
            one->out.f_t[1] = ASPERITY_R(a.f_t[1][k]);
            one->out.stiffness = ASPERITY_R(a.stiffness[k]);
            one->out.stored = ASPERITY_R(a.stored[k]);
            one->out.plastic = ASPERITY_R(a.total[k]);
            one->out.friction = ASPERITY_R(a.slip[k]);
            one->out.unsolved = ASPERITY_R(0.0);
        } else if (what == ASPERITY_ELASTIC && sound[k]) {
            yields->one[yields->count] = one;
            yields->by[yields->count++] = by[k];
        } else {
            asperity_advance(t, one->radius, modulus, one->state, NULL, one->h, one->d, one->next, &one->out, NULL);
        }
    }
    asperity_unload(&after, next);
    queue->count -= count;
    for (k = 0; k < queue->count; k++) {
        queue->one[k] = queue->one[count + k];
        queue->by[k] = queue->by[count + k];
    }
}
#endif

/* Moves several contacts of one law, each as asperity_update() moves it: by the same equations, to rounding. What one contact gets does not depend on the others, to
 * the last bit. With the vectors of the machine several are solved side by side. */
ASPERITY_FN void asperity_update_many(const asperity_table *t, asperity_real modulus, int count, asperity_increment *increments) {
#if ASPERITY_WIDTH > 1
    /* Those that are whole mostly yield; of those that are released, such as yielded in their last step. */
    asperity_queue whole, flowing, released;
    int k;
    whole.count = flowing.count = released.count = 0;
    for (k = 0; k < count; k++) {
        asperity_increment *one = &increments[k];
        asperity_queue *queue = !(one->state->approach < one->state->reach) ? &whole : one->state->hint[2] > ASPERITY_R(0.0) ? &flowing : &released;
        if (asperity_enter(one->radius, one->state, 1, one->h, one->d, one->next, &one->out, NULL, &queue->by[queue->count])) {
            queue->one[queue->count++] = one;
        }
        if (whole.count == ASPERITY_WIDTH) {
            asperity_advance_wide(t, modulus, ASPERITY_FORCES, &whole, NULL);
        }
        if (released.count == ASPERITY_WIDTH) {
            asperity_advance_wide(t, modulus, ASPERITY_ELASTIC, &released, &flowing);
        }
        if (flowing.count >= ASPERITY_WIDTH) {
            asperity_advance_wide(t, modulus, ASPERITY_FORCES, &flowing, NULL);
        }
    }
    if (released.count > 0) {
        asperity_advance_wide(t, modulus, ASPERITY_ELASTIC, &released, &flowing);
    }
    while (flowing.count > 0) {
        asperity_advance_wide(t, modulus, ASPERITY_FORCES, &flowing, NULL);
    }
    if (whole.count > 0) {
        asperity_advance_wide(t, modulus, ASPERITY_FORCES, &whole, NULL);
    }
#else
    int k;
    for (k = 0; k < count; k++) {
        asperity_increment *one = &increments[k];
        asperity_update(t, one->radius, modulus, one->state, one->h, one->d, one->next, &one->out, NULL);
    }
#endif
}
