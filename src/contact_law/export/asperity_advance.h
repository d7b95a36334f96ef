/* From a step over R to its answer. No guard: included once. */

/* The answer in the user's units. Returns 0 where it is no number. */
ASPERITY_FN int asperity_answer(asperity_real radius, asperity_real modulus, const asperity_account *a, asperity_response *out) {
    double force = (double)modulus * (double)radius * (double)radius, work = force * (double)radius, stiff = (double)modulus * (double)radius;
    if (!asperity_is_finite(ASPERITY_R(a->stored)) || !asperity_is_finite(ASPERITY_R(a->f_n + a->f_t[0] + a->f_t[1]))) {
        return 0;
    }
    out->f_n = ASPERITY_R(a->f_n * force);
    out->f_t[0] = ASPERITY_R(a->f_t[0] * force);
    out->f_t[1] = ASPERITY_R(a->f_t[1] * force);
    out->stiffness = ASPERITY_R(a->stiffness * stiff);
    out->stored = ASPERITY_R(a->stored * work);
    out->friction = ASPERITY_R(a->slip * work);
    out->plastic = ASPERITY_R((a->total - a->slip) * work);
    out->unsolved = ASPERITY_R(a->unsolved);
    return 1;
}

/* A step in so many parts. Returns whether the answers of all were found; of ASPERITY_PARTS what is nearest will do. */
ASPERITY_FN int asperity_move_in(
    const asperity_table *t, int parts, const asperity_work *s, asperity_twist *twist, const asperity_entry *by, int what, asperity_account *a, asperity_work *after,
    asperity_guess *ASPERITY_ALONE o) {
    const double share = 1.0 / parts, d[2] = {by->d[0] * share, by->d[1] * share};
    asperity_work from = *s;
    asperity_twist turn;
    asperity_step p;
    int k;
    p.last = parts == ASPERITY_PARTS;
    a->total = a->slip = a->unsolved = 0.0;
    if (twist) {
        turn = *twist;
        turn.along *= share;
        turn.trial = turn.ratio + (turn.trial - turn.ratio) * share;
    }
    for (k = 1; k <= parts; k++) {
        double h = k < parts ? s->h + (by->h - s->h) * (k * share) : by->h;
        if (!asperity_move(t, &from, twist ? &turn : NULL, h, d, k < parts ? ASPERITY_FORCES : what, &p, after, o)) {
            return 0;
        }
        asperity_account_for(&p, o, a);
        if (twist) {
            memcpy(turn.sector, o->sector, sizeof turn.sector);
            turn.vertex = o->plastic && o->f_n > 0.0 ? o->twist_vertex : turn.vertex;
        }
        from = *after;
    }
    if (twist) {
        memcpy(twist->sector, turn.sector, sizeof turn.sector);
        twist->vertex = turn.vertex;
    }
    return 1;
}

/* The update with a twist, or none; its forces around the normal are left there. A step that is so long that its answer is not found is taken in parts: flow that fades at full slip may leave
 * it several, and a slower one comes to the right one. The tangent is that of the last part. */
ASPERITY_FN void asperity_advance(
    const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state, asperity_twist *twist, asperity_real h,
    const asperity_real increment[2], asperity_state *next, asperity_response *out, asperity_tangent *tangent) {
    const double stiff = (double)modulus * (double)radius;
    asperity_work s, after;
    asperity_guess o;
    asperity_entry by;
    asperity_account a;
    int parts = 1;
    if (!asperity_enter(radius, state, 0, h, increment, next, out, tangent, &by)) {
        if (twist) {
            memset(twist->sector, 0, sizeof twist->sector);
        }
        return;
    }
    asperity_begin(state, &s);
    o.left = ASPERITY_ALL_GUESSES;
    while (!asperity_move_in(t, parts, &s, twist, &by, tangent ? ASPERITY_SLOPES : ASPERITY_FORCES, &a, &after, &o)) {
        parts *= 2;
    }
    if (!asperity_answer(radius, modulus, &a, out)) {
        asperity_refuse(out, tangent);
        *next = *state;
        return;
    }
    if (tangent) {
        tangent->df_n_dh = ASPERITY_R(o.tangent[0][0] * stiff);
        tangent->df_t_dh[0] = ASPERITY_R(o.tangent[0][1] * stiff);
        tangent->df_t_dh[1] = ASPERITY_R(o.tangent[0][2] * stiff);
        tangent->df_n_ddelta[0] = ASPERITY_R(o.tangent[1][0] * stiff);
        tangent->df_n_ddelta[1] = ASPERITY_R(o.tangent[2][0] * stiff);
        tangent->df_t_ddelta[0][0] = ASPERITY_R(o.tangent[1][1] * stiff);
        tangent->df_t_ddelta[0][1] = ASPERITY_R(o.tangent[2][1] * stiff);
        tangent->df_t_ddelta[1][0] = ASPERITY_R(o.tangent[1][2] * stiff);
        tangent->df_t_ddelta[1][1] = ASPERITY_R(o.tangent[2][2] * stiff);
        tangent->a = ASPERITY_R(asperity_radius(t, &after) * (double)radius);
    }
    asperity_end(&after, next);
}
