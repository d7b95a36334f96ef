/* What a guess of the hardening and of F_T/F_N gives, of one contact or, where asperity_v is several numbers, of as many contacts side by side, each as if it were alone. No guard: included once for each form.
 * Of several, masks choose what is of which contact; only what none needs is left out, so that none feels the others. */

/* An elastic step. Returns whether there is contact. */
ASPERITY_FN asperity_m asperity_elastic(const asperity_step *p, asperity_guess *ASPERITY_ALONE o) {
    asperity_m touches = p->e > 0.0;
    int i;
    o->slip[0] = o->slip[1] = o->hardens = asperity_all(0.0);
    o->move[0] = p->d[0];
    o->move[1] = p->d[1];
    o->move[2] = asperity_all(0.0);
    o->turn = ASPERITY_TWISTS(p) ? p->twist->along : asperity_all(0.0);
    o->width = p->wide;
    o->e = p->e;
    o->reach = asperity_choose(p->e > p->s->reach, p->e, p->s->reach); /* without contact e is below it */
    if (ASPERITY_SEVERAL || asperity_any(touches)) {
        o->f_n = asperity_choose(touches, p->f_n, asperity_all(0.0));
        o->sum = asperity_limits(p->lost, o->eta, o->own);
        o->limit = o->own;
        asperity_slide(p, p->row.stiff, o);
    }
    if (asperity_any(asperity_not(touches))) {
        o->f_n = asperity_choose(touches, o->f_n, asperity_all(0.0));
        o->f_t[0] = asperity_choose(touches, o->f_t[0], asperity_all(0.0));
        o->f_t[1] = asperity_choose(touches, o->f_t[1], asperity_all(0.0));
        for (i = 0; i < ASPERITY_CELLS; i++) {
            o->slider[0][i] = asperity_choose(touches, o->slider[0][i], asperity_all(0.0));
            o->slider[1][i] = asperity_choose(touches, o->slider[1][i], asperity_all(0.0));
            o->slider[2][i] = asperity_choose(touches, o->slider[2][i], asperity_all(0.0));
        }
        if (ASPERITY_TWISTS(p)) {
            memset(o->sector, 0, sizeof o->sector);
        }
    }
    return touches;
}

/* Plastic slip at a guess: the steady flow along r and the flow away from the vertex, sudden while the yield factor grows. */
ASPERITY_FN void asperity_flow(const asperity_step *p, asperity_spot at, asperity_v rate, asperity_guess *ASPERITY_ALONE o) {
    const asperity_row *row = &o->row;
    asperity_v flow_s[2], mobile_s[2], gap = row->approach, per = 1.0 / (o->ratio + 1e-9), per_round = 1.0 / o->round;
    asperity_v steady = asperity_shape(p->t, row, ASPERITY_FLOW, at, o->cell, flow_s), grown = o->factor - p->growing;
    int i;
    o->mobile = asperity_shape(p->t, row, ASPERITY_MOBILISED, at, o->cell, mobile_s);
    o->mobile_r = mobile_s[0] * p->per_friction;
    o->grown = asperity_choose(grown > 0.0, grown, asperity_all(0.0));
    o->sudden = o->hardens * p->sudden + o->grown * gap * o->mobile;
    o->flow = o->hardens * steady * per;
    o->flow_y = (rate * steady + o->hardens * flow_s[1] * row->share_slope) * per;
    o->flow_r = o->hardens * (flow_s[0] * p->per_friction - steady * per) * per;
    o->sudden_y = rate * p->sudden + o->grown * (row->approach_slope * o->mobile + gap * mobile_s[1] * row->share_slope);
    if (ASPERITY_TWISTS(p)) {
        o->flow *= p->twist->flows;
        o->flow_y *= p->twist->flows;
        o->flow_r *= p->twist->flows;
    }
    for (i = 0; i < 2; i++) {
        o->slip[i] = o->flow * o->r[i] + o->sudden * o->x[i] * per_round;
        o->move[i] = p->d[i] - o->slip[i];
    }
    o->move[2] = p->radial * o->hardens;
    if (ASPERITY_TWISTS(p)) { /* by the ratio after the flow, were all to stick: by the one before it, flow would overshoot */
        asperity_v sudden = o->sudden * o->c * per_round, gives = p->twist->gives, vertex = p->twist->vertex;
        o->per_turn = 1.0 / (1.0 + gives * (o->flow + sudden));
        o->turned = (p->twist->trial + gives * sudden * vertex) * o->per_turn;
        o->turn = p->twist->along - ASPERITY_TWIST_FLOW / ASPERITY_TWIST_LEVER * (o->flow * o->turned + sudden * (o->turned - vertex));
    }
}

/* The yield factor at a guess, and the elastic force that goes with it. Returns whether there is contact. */
ASPERITY_FN asperity_m asperity_yield(const asperity_step *p, asperity_v y, const asperity_v r[2], asperity_guess *ASPERITY_ALONE o) {
    const asperity_table *t = p->t;
    const asperity_work *s = p->s;
    asperity_row *row = &o->row;
    asperity_v z = y * p->per_depth, rate, ln_force, ln_stiff;
    asperity_m touches, small;
    double eps = ASPERITY_VERTEX_ROUND * p->friction;
    asperity_spot at;
    int i;
    asperity_read(t, p->depth + y, p->log_h + asperity_log_near(z), row);
    ln_force = row->value[ASPERITY_LN_FORCE] - p->row.value[ASPERITY_LN_FORCE];
    ln_stiff = row->value[ASPERITY_LN_STIFFNESS] - p->row.value[ASPERITY_LN_STIFFNESS];
    row->force = p->row.force * asperity_exponential_near(ln_force);
    row->stiff = p->row.stiff * asperity_exponential_near(ln_stiff);
    o->hardens = row->dent - p->dent;
    rate = row->dent_slope;
    /* The vertex follows r. */
    o->per_length = p->row.stiff / p->row.force * (1.0 / ASPERITY_VERTEX_LENGTH) * p->per_friction * asperity_exponential_near(ln_stiff - ln_force);
    o->q = o->hardens * o->per_length;
    o->c = 1.0 / (1.0 + o->q);
    for (i = 0; i < 2; i++) {
        o->r[i] = r[i];
        o->x[i] = (r[i] - s->vertex[i]) * o->c;
        o->vertex[i] = r[i] - o->x[i];
    }
    o->untwisted = ASPERITY_TWISTS(p) ? (p->twisted - p->twist->vertex) * o->c : asperity_all(0.0);
    o->twist_vertex = p->twisted - o->untwisted;
    o->ratio = asperity_root(r[0] * r[0] + r[1] * r[1] + p->twisted * p->twisted);
    o->far = asperity_root(o->x[0] * o->x[0] + o->x[1] * o->x[1] + o->untwisted * o->untwisted);
    o->round = asperity_root(o->far * o->far + eps * eps);
    at = asperity_find(o->ratio * p->per_friction);
    o->factor = asperity_factor(t, p->per_friction, row, at, o->far, o->cell, o->part);
    o->e = p->e - o->hardens;
    touches = o->e > 0.0;
    if (!asperity_any(touches)) {
        return touches;
    }
    /* g follows the yield factor, by the share that is wide, as the contact hardens: at once, F_N would jump where it yields. */
    {
        asperity_v per = p->per_narrows, kept = asperity_exponential(-o->hardens * per), grown = o->factor - 1.0;
        asperity_v away = (s->stiffened - row->wide * grown) * kept;
        o->width = 1.0 + row->wide * grown + away;
        o->width_factor = row->wide * (1.0 - kept);
        o->width_y = row->wide_slope * grown * (1.0 - kept) - away * rate * per;
    }
    z = (o->width - p->wide) / p->wide;
    small = asperity_size(z) < 0.015625; /* most steps are */
    o->log_width = p->log_wide + asperity_log_series(z);
    if (asperity_any(asperity_not(small))) {
        o->log_width = asperity_choose(small, o->log_width, asperity_logarithm(o->width));
    }
    o->level = asperity_logarithm(o->e / row->approach);
    o->f_n = row->force * asperity_exponential_near(row->value[ASPERITY_GAMMA] * o->level + (row->value[ASPERITY_GAMMA] - 1.0) * o->log_width);
    asperity_flow(p, at, rate, o);
    return touches;
}

/* The residuals at a guess. Returns whether there is contact. */
ASPERITY_FN asperity_m asperity_evaluate(const asperity_step *p, asperity_v y, const asperity_v r[2], asperity_guess *ASPERITY_ALONE o) {
    asperity_m touches = asperity_yield(p, y, r, o), released = p->e < p->s->reach, softened = p->rho_log > 0.0;
    asperity_v per;
    int i;
    if (!asperity_any(touches)) {
        o->residual[0] = o->residual[1] = o->residual[2] = asperity_all(0.0);
        return touches;
    }
    o->reach = o->e;
    o->limit = p->limit;
    o->sum = p->sum;
    o->eta = asperity_all(1.0);
    o->log_share = o->eta_y = o->eta_h = asperity_all(0.0);
    if (asperity_any(released)) { /* the annuli that a release took come back as the contact hardens */
        asperity_v per_length = p->per_narrows, reach = asperity_choose(released, p->s->reach, asperity_all(1.0));
        asperity_v away = asperity_choose(released, 1.0 - p->e / reach, asperity_all(0.0)), kept = asperity_exponential(-o->hardens * per_length), whole = 1.0 - away * kept;
        asperity_v gamma = o->row.value[ASPERITY_GAMMA], log_whole = asperity_logarithm(whole);
        o->reach = asperity_choose(released, o->e / whole, o->e);
        o->log_share = asperity_choose(released, gamma * log_whole, asperity_all(0.0));
        o->eta = asperity_choose(released, asperity_exponential(o->log_share * p->per_exponent), asperity_all(1.0));
        o->eta_y = o->eta * p->per_exponent * (gamma * away * kept * o->row.dent_slope * per_length / whole + o->row.slope[ASPERITY_GAMMA] * log_whole);
        o->eta_h = o->eta * p->per_exponent * gamma * kept / (reach * whole);
        o->sum = asperity_choose(released, asperity_limits(p->lost, o->eta, o->own), p->sum);
        for (i = 0; ASPERITY_SEVERAL && i < ASPERITY_CELLS; i++) {
            o->own[i] = asperity_choose(released, o->own[i], p->limit[i]);
        }
        o->limit = o->own;
    }
    asperity_slide(p, o->row.stiff, o);
    o->rho = p->rho;
    o->rho_y = asperity_all(0.0);
    o->rho_h = p->rho_slope;
    if (asperity_any(softened)) { /* what releases took comes back with flow */
        asperity_v per_dent = ASPERITY_RECOVERS / p->approach, missing = asperity_choose(softened, 1.0 / (p->rho_log + per_dent * o->hardens), asperity_all(0.0));
        o->rho = asperity_choose(softened, asperity_exponential(-missing), p->rho);
        o->rho_y = o->rho * missing * missing * per_dent * o->row.dent_slope;
        o->rho_h = asperity_choose(softened, o->rho_h * (o->rho * missing * missing * p->rho_log * p->rho_log / p->rho), o->rho_h);
    }
    per = 1.0 / o->f_n;
    o->residual[0] = o->f_n * o->factor / o->row.force - o->rho * p->kept;
    o->residual[1] = o->f_t[0] * per - r[0];
    o->residual[2] = o->f_t[1] * per - r[1];
    return touches;
}

/* Slopes of the residuals and forces at the guess that was evaluated last, along y and r and, where all six are asked for, along h and d. Those of contacts that need none stay. */
ASPERITY_FN void asperity_guess_slopes(const asperity_step *p, int count, asperity_m need, asperity_guess *ASPERITY_ALONE o) {
    const asperity_row *row = &o->row;
    asperity_v gamma = row->value[ASPERITY_GAMMA], gap = row->approach, rate = row->dent_slope, per = 1.0 / o->f_n, per_round = 1.0 / o->round;
    asperity_v y_of_force = row->slope[ASPERITY_LN_FORCE] + row->slope[ASPERITY_GAMMA] * (o->level + o->log_width) - gamma * (rate / o->e + row->approach_slope / gap);
    asperity_v q_y = rate * o->per_length + o->q * (row->slope[ASPERITY_LN_STIFFNESS] - row->slope[ASPERITY_LN_FORCE]);
    asperity_v v[2], per_ratio = asperity_choose(o->ratio > 0.0, 1.0 / o->ratio, asperity_all(0.0)), far = asperity_choose(o->far > 0.0, o->round / o->far, asperity_all(0.0));
    asperity_v by_worn[2], opens[2], load = o->f_n * o->factor / row->force, by_width = (gamma - 1.0) / o->width, per_factor = 1.0 / o->factor, none = asperity_all(0.0);
    /* Where it begins to grow, Newton's first step has to know. */
    const asperity_m grows = count == 3 ? (o->grown > 0.0) | (p->rises & (o->factor > p->growing - 1e-9)) : o->grown > 0.0;
    int i, j;
    v[0] = o->x[0] * per_round;
    v[1] = o->x[1] * per_round;
    by_worn[0] = by_worn[1] = none;
    asperity_slide_slopes(p, row->stiff, o);
    asperity_eta_slopes(p, o, opens);
    if (count > 3) {
        asperity_worn_slopes(p, o, by_worn);
    }
    ASPERITY_UNROLL
    for (j = 0; j < count; j++) { /* along y, r, h, d */
        asperity_v dx[2], dmove[3], dround = none, dratio = none, dfactor = none, df = none, dsudden = none, dflow = none, dturn = none, dt, dq = none;
        dx[0] = dx[1] = dmove[2] = none;
        if (j == 0) {
            dq = q_y;
            dx[0] = -o->c * o->x[0] * q_y;
            dx[1] = -o->c * o->x[1] * q_y;
            dround = v[0] * dx[0] + v[1] * dx[1];
            if (ASPERITY_TWISTS(p)) {
                dround -= o->untwisted * per_round * o->c * o->untwisted * q_y;
            }
            dfactor = o->part[1] * dround * far + o->part[2];
            df = y_of_force + by_width * (o->width_factor * dfactor + o->width_y);
            dsudden = o->sudden_y;
            dflow = o->flow_y;
            dmove[2] = p->radial * rate;
        } else if (j < 3) {
            dx[j - 1] = o->c;
            dround = v[j - 1] * o->c;
            dratio = o->r[j - 1] * per_ratio;
            dfactor = o->part[0] * dratio + o->part[1] * dround * far;
            df = by_width * o->width_factor * dfactor;
            dflow = o->flow_r * dratio;
        } else if (j == 3) {
            df = gamma / o->e; /* over F_N, as all df */
        }
        if (j < 4 && asperity_any(grows)) {
            asperity_v more = gap * ((j == 3 ? -p->growing_slope : dfactor) * o->mobile + o->grown * o->mobile_r * dratio);
            dsudden += asperity_choose(grows, more, none);
        }
        for (i = 0; i < 2; i++) {
            dmove[i] = -dsudden * v[i];
            if (j < 3) {
                dmove[i] -= dflow * o->r[i] + o->sudden * (dx[i] - v[i] * dround) * per_round;
            }
            if (j == 1 + i) {
                dmove[i] -= o->flow;
            } else if (j == 4 + i) {
                dmove[i] += 1.0;
            }
        }
        if (ASPERITY_TWISTS(p)) {
            dt = o->c * per_round * (dsudden - o->sudden * (o->c * dq + dround * per_round));
            dturn = -ASPERITY_TWIST_FLOW / ASPERITY_TWIST_LEVER * o->per_turn * (dflow * o->turned + dt * (o->turned - p->twist->vertex));
        }
        o->n_by[j] = o->f_n * df;
        for (i = 0; i < 2; i++) {
            dt = o->m[i] * dmove[0] + o->m[i + 1] * dmove[1] + o->wider[i] * df;
            if (j == 0) {
                dt += o->radial[i] * dmove[2] + o->stiffer[i] * row->stiff * row->slope[ASPERITY_LN_STIFFNESS] + opens[i] * o->eta_y;
            } else if (j == 3) {
                dt += opens[i] * o->eta_h;
            }
            if (j > 2) {
                dt += by_worn[i] * p->worn_by[j > 2 ? j - 3 : 0];
            }
            if (ASPERITY_TWISTS(p)) {
                dt += o->by_turn[i] * dturn;
            }
            o->t_by[j][i] = dt;
            asperity_put(need, o->by[j][1 + i], (j == 1 + i ? (dt - o->f_t[i] * df) * per - 1.0 : (dt - o->f_t[i] * df) * per));
        }
        dt = load * (df + dfactor * per_factor);
        if (j == 0) {
            dt -= load * row->slope[ASPERITY_LN_FORCE] + p->kept * o->rho_y;
        } else if (j == 3) {
            dt -= p->kept * o->rho_h;
        }
        asperity_put(need, o->by[j][0], dt);
    }
}

/* Moves y and r by x so that the three equations, off by `right`, are met. Returns whether they can be. */
ASPERITY_FN asperity_m asperity_solve(const asperity_guess *o, const asperity_v right[3], asperity_v x[3]) {
    const asperity_v *a = o->by[0], *b = o->by[1], *c = o->by[2]; /* columns */
    asperity_v bc[3], whole, per;
    asperity_m can;
    bc[0] = b[1] * c[2] - b[2] * c[1];
    bc[1] = b[2] * c[0] - b[0] * c[2];
    bc[2] = b[0] * c[1] - b[1] * c[0];
    whole = -(a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2]);
    can = asperity_size(whole) > 0.0;
    if (!asperity_any(can)) {
        return can;
    }
    per = 1.0 / whole;
    x[0] = (right[0] * bc[0] + right[1] * bc[1] + right[2] * bc[2]) * per;
    x[1] = (a[0] * (right[1] * c[2] - right[2] * c[1]) + a[1] * (right[2] * c[0] - right[0] * c[2]) + a[2] * (right[0] * c[1] - right[1] * c[0])) * per;
    x[2] = (a[0] * (b[1] * right[2] - b[2] * right[1]) + a[1] * (b[2] * right[0] - b[0] * right[2]) + a[2] * (b[0] * right[1] - b[1] * right[0])) * per;
    return can;
}

/* Of the contacts in question, moves r by x[1], x[2] so that its two equations are met where y moves by dy, x[0]. */
ASPERITY_FN void asperity_solve_at(const asperity_guess *o, asperity_m which, asperity_v dy, asperity_v x[3]) {
    const asperity_v *a = o->by[0], *b = o->by[1], *c = o->by[2];
    asperity_v right[2], whole = b[1] * c[2] - c[1] * b[2];
    asperity_m can = which & (asperity_size(whole) > 0.0);
    right[0] = -o->residual[1] - a[1] * dy;
    right[1] = -o->residual[2] - a[2] * dy;
    asperity_put(which, x[0], dy);
    if (asperity_any(can)) {
        x[1] = asperity_choose(can, (right[0] * c[2] - c[1] * right[1]) / whole, x[1]);
        x[2] = asperity_choose(can, (b[1] * right[1] - right[0] * b[2]) / whole, x[2]);
    }
}

/* No contact hardens more in a step. */
ASPERITY_FN asperity_v asperity_most(const asperity_step *p) {
    return 3.0 * (p->e + p->depth);
}

/* The hardening that brings F_N to the yield force, where the dent and D go on straight and r stays: `load` is F_N G/P, `factor` its G. */
ASPERITY_FN asperity_v asperity_first_guess(const asperity_step *p, asperity_v load) {
    asperity_v gamma = p->row.value[ASPERITY_GAMMA], most = asperity_most(p), left, y;
    left = asperity_exponential(-asperity_logarithm(load / (p->rho * p->kept)) / gamma);
    y = p->e * (1.0 - left) / (p->row.dent_slope + left * p->e / p->approach * p->row.approach_slope);
    return asperity_choose(y > 0.0, asperity_choose(y < most, y, most), asperity_all(0.0));
}

/* Where Newton's method begins in a short step of a contact that has yielded before: as far on the way to the trial's ratio as in its last step that yielded, along the ratio of the
 * start and across it, and with as much of the hardening that the trial would bring; `load` is the trial's F_N G/P. Returns for which contacts; y and r of the others stay. */
ASPERITY_FN asperity_m asperity_hinted(asperity_step *p, const asperity_v trial[2], asperity_v load, asperity_v *y, asperity_v r[2]) {
    const asperity_v *hint = p->s->hint;
    asperity_v per = 1.0 / asperity_root(r[0] * r[0] + r[1] * r[1] + 1e-200), x = trial[0] - r[0], z = trial[1] - r[1], along, across;
    asperity_m hinted = (asperity_size(hint[2]) > 0.0) & (p->old_f_n > 0.0) & (x * x + z * z < ASPERITY_HINT_SHORT * ASPERITY_HINT_SHORT * p->friction * p->friction);
    p->axis[0] = r[0] * per;
    p->axis[1] = r[1] * per;
    p->toward[0] = x * p->axis[0] + z * p->axis[1];
    p->toward[1] = z * p->axis[0] - x * p->axis[1];
    p->trial = asperity_first_guess(p, load);
    along = hint[0] * p->toward[0];
    across = hint[1] * p->toward[1];
    asperity_put(hinted, r[0], r[0] + (along * p->axis[0] - across * p->axis[1]));
    asperity_put(hinted, r[1], r[1] + (along * p->axis[1] + across * p->axis[0]));
    asperity_put(hinted, *y, asperity_size(hint[2]) * p->trial);
    return hinted;
}

/* A number within bounds, and the lower one where it is none. */
ASPERITY_FN asperity_v asperity_within(asperity_v x, double least, double most) {
    return asperity_choose(x > least, asperity_choose(x < most, x, asperity_all(most)), asperity_all(least));
}

/* The hint that a step leaves in which the contact yielded, from the ratio at its start. Where the way in one direction is too short to tell, that of before stays. */
ASPERITY_FN void asperity_keep_hint(const asperity_step *p, asperity_m flows, asperity_v y, const asperity_v r[2], const asperity_v start[2], asperity_work *next) {
    asperity_v x = r[0] - start[0], z = r[1] - start[1], along = p->toward[0] * p->toward[0], across = p->toward[1] * p->toward[1], least = 0.01 * (along + across);
    asperity_put(flows & (along > least), next->hint[0], asperity_within((x * p->axis[0] + z * p->axis[1]) / p->toward[0], -2.0, 2.0));
    asperity_put(flows & (across > least), next->hint[1], asperity_within((z * p->axis[0] - x * p->axis[1]) / p->toward[1], -2.0, 2.0));
    asperity_put(flows, next->hint[2], asperity_within(y / p->trial, 0.01, 10.0));
}
