/* One step of one contact or, where asperity_v is several numbers, of as many contacts side by side, each as if it were alone. No guard: included once for each form.
 * Of several, masks choose what is of which contact; only what none needs is left out, so that none feels the others. */

/* What a step starts from: the row, the elastic trial's place, the forces and energy so far. */
ASPERITY_FN void asperity_prepare(const asperity_table *t, const asperity_work *s, asperity_v h, const asperity_v d[2], asperity_step *p) {
    asperity_row *row = &p->row;
    asperity_v e0, gamma, level = asperity_all(0.0);
    asperity_m kept, held, touches;
    p->t = t;
    p->s = s;
    p->twisted = ASPERITY_TWISTS(p) ? p->twist->ratio : asperity_all(0.0);
    p->kept = ASPERITY_TWISTS(p) ? p->twist->kept : asperity_all(1.0);
    p->friction = (double)t->friction > 1e-9 ? (double)t->friction : 1e-9;
    p->per_friction = 1.0 / p->friction;
    p->h = h;
    p->d[0] = d[0];
    p->d[1] = d[1];
    p->depth = (double)t->first + s->hardened;
    p->per_depth = 1.0 / p->depth;
    p->log_h = asperity_choose(s->hardened > 0.0, asperity_logarithm(1.0 + s->hardened / (double)t->first), asperity_all(0.0));
#if ASPERITY_SEVERAL
    row->at = asperity_nowhere();
#endif
    asperity_read(t, p->depth, p->log_h, row);
    row->force = asperity_exponential(row->value[ASPERITY_LN_FORCE]);
    row->stiff = asperity_exponential(row->value[ASPERITY_LN_STIFFNESS]);
    p->approach = row->approach;
    p->per_narrows = 1.0 / (ASPERITY_NARROWS * p->approach);
    /* The dent that the memory has, where it has one, and the approach by differences: so float does not lose what hardens less in a step than a last digit. */
    p->dent = s->h - s->approach;
    kept = (s->approach > 0.0) & (asperity_size(p->dent - row->dent) <= 16.0 * ASPERITY_ROUNDING * p->depth);
    p->dent = asperity_choose(kept, p->dent, row->dent);
    e0 = asperity_choose(s->approach > 0.0, asperity_choose(kept, s->approach, s->h - p->dent), asperity_all(0.0));
    p->e = asperity_choose(kept, e0 + (h - s->h), h - p->dent);
    p->wide = 1.0 + s->stiffened;
    p->log_wide = asperity_choose(s->stiffened > 0.0, asperity_logarithm(p->wide), asperity_all(0.0));
    gamma = row->value[ASPERITY_GAMMA];
    touches = p->e > 0.0;
    held = e0 > 0.0;
    p->level = asperity_choose(touches, asperity_logarithm(p->e / p->approach), asperity_all(0.0));
    p->old_f_n = p->old_f_t[0] = p->old_f_t[1] = p->old_stored[0] = p->old_stored[1] = p->f_n = asperity_all(0.0);
    if (asperity_any(held)) {
        asperity_v z = asperity_choose(touches, (e0 - p->e) / p->e, asperity_all(1.0));
        asperity_m small = asperity_size(z) < 0.015625;
        level = p->level + asperity_log_series(z);
        if (asperity_any(asperity_not(small))) {
            level = asperity_choose(small, level, asperity_logarithm(e0 / p->approach));
        }
        p->old_f_n = asperity_choose(held, row->force * asperity_exponential(gamma * level + (gamma - 1.0) * p->log_wide), asperity_all(0.0));
        p->old_f_t[0] = asperity_choose(held, asperity_sum(s->slider[0]), asperity_all(0.0));
        p->old_f_t[1] = asperity_choose(held, asperity_sum(s->slider[1]), asperity_all(0.0));
        p->old_stored[0] = p->old_f_n * e0 / (gamma + 1.0);
        p->old_stored[1] = asperity_choose(held, asperity_slider_energy(s->slider[0], s->slider[1], row->stiff), asperity_all(0.0));
        p->f_n = asperity_choose(touches, p->old_f_n * asperity_exponential_near(gamma * (p->level - level)), asperity_all(0.0));
    }
    if (asperity_any(touches & asperity_not(held))) {
        p->f_n = asperity_choose(touches & asperity_not(held), row->force * asperity_exponential(gamma * p->level + (gamma - 1.0) * p->log_wide), p->f_n);
    }
}

/* The memory after a step, of the contacts in question; `flows`: those that yielded. */
ASPERITY_FN void asperity_keep(
    const asperity_step *p, const asperity_guess *o, asperity_m which, asperity_m flows, asperity_v y, asperity_v softened, asperity_v released, asperity_work *next) {
    const asperity_work *s = p->s;
    asperity_m moves = flows & (o->f_n > 0.0);
    int i, j;
    asperity_put(which, next->h, p->h);
    asperity_put(which, next->h_max, asperity_choose(p->h > s->h_max, p->h, s->h_max));
    asperity_put(which, next->approach, o->e);
    asperity_put(which, next->hardened, s->hardened + y);
    asperity_put(which, next->reach, o->reach);
    asperity_put(which, next->softened, softened);
    asperity_put(which, next->released, released);
    asperity_put(which, next->worn, p->worn);
    asperity_put(which, next->stiffened, asperity_choose(moves, asperity_choose(o->width > 1.0, o->width - 1.0, asperity_all(0.0)), s->stiffened));
    asperity_put(which, next->vertex[0], asperity_choose(moves, o->vertex[0], s->vertex[0]));
    asperity_put(which, next->vertex[1], asperity_choose(moves, o->vertex[1], s->vertex[1]));
    for (j = 0; j < 3; j++) {
        for (i = 0; i < ASPERITY_CELLS; i++) {
            asperity_put(which, next->slider[j][i], o->slider[j][i]);
        }
        asperity_put(which, next->hint[j], j < 2 ? s->hint[j] : -asperity_size(s->hint[j]));
    }
}

/* Newton's method for the hardening y and the ratio r of the contacts in question, from a guess. Returns of which they are found, and o is of them. */
ASPERITY_FN asperity_m asperity_newton(const asperity_step *p, asperity_m active, asperity_v *y, asperity_v r[2], asperity_guess *ASPERITY_ALONE o) {
    asperity_v from[3], step[3], least = asperity_all(1e300), most = asperity_most(p), back = asperity_all(0.0), norm, size;
    asperity_m found = asperity_not(ASPERITY_EVERY), known = found, touches, anew, backs, fails, goes;
    double bound = 0.5 * p->friction + 0.01;
    int tries, i;
    for (i = 0; i < 3; i++) {
        from[i] = step[i] = asperity_all(0.0);
    }
#if ASPERITY_SEVERAL
    memset(o->by, 0, sizeof o->by);
    o->row.at = p->row.at;
    memcpy(o->row.low, p->row.low, sizeof o->row.low);
    memcpy(o->row.rise, p->row.rise, sizeof o->row.rise);
#endif
    for (tries = 1;; tries++) {
        touches = asperity_evaluate(p, *y, r, o);
        norm = asperity_choose(touches, o->residual[0] * o->residual[0] + o->residual[1] * o->residual[1] + o->residual[2] * o->residual[2], asperity_all(1e300));
        found |= active & (norm < ASPERITY_NEAR * ASPERITY_NEAR);
        active &= asperity_not(found);
        if (!asperity_any(active)) {
            return found;
        }
        anew = tries == 1 ? active & asperity_not(touches) : asperity_not(ASPERITY_EVERY); /* beyond what it can harden: from none */
        asperity_put(anew, *y, asperity_all(0.0));
        backs = tries > 1 ? active & asperity_not(norm <= 1.1 * least) & (back < 6.0) : asperity_not(ASPERITY_EVERY);
        if (asperity_any(backs)) {
            for (i = 0; i < 3; i++) {
                asperity_put(backs, step[i], 0.4 * step[i]);
            }
            asperity_put(backs, back, back + 1.0);
        }
        goes = active & asperity_not(anew | backs);
        if (asperity_any(goes)) {
            fails = tries >= ASPERITY_TRIES ? goes : goes & asperity_not(touches);
            found |= fails & (norm < ASPERITY_ENOUGH);
            active &= asperity_not(fails);
            goes &= asperity_not(fails);
            /* Near to it the slopes of before are good enough: what they leave is norm^2/least, of the squares. */
            touches = goes & asperity_not(known & (norm * norm < 0.01 * ASPERITY_NEAR * ASPERITY_NEAR * least));
            if (asperity_any(touches)) {
                asperity_guess_slopes(p, 3, touches, o);
                known |= touches;
            }
            {
                asperity_v to[3];
                asperity_m can, beyond;
                to[0] = to[1] = to[2] = asperity_all(0.0);
                can = asperity_solve(o, o->residual, to);
                fails = goes & asperity_not(can);
                found |= fails & (norm < ASPERITY_ENOUGH);
                active &= asperity_not(fails);
                goes &= can;
                for (i = 0; i < 3; i++) {
                    asperity_put(goes, step[i], to[i]);
                }
                beyond = goes & (*y + step[0] < 0.0);
                if (asperity_any(beyond)) {
                    asperity_solve_at(o, beyond, -0.7 * *y, step);
                }
                beyond = goes & asperity_not(beyond) & (*y + step[0] > most);
                if (asperity_any(beyond)) {
                    asperity_solve_at(o, beyond, 0.7 * (most - *y), step);
                }
            }
            asperity_put(goes, back, asperity_all(0.0));
            asperity_put(goes, least, norm);
            asperity_put(goes, from[0], *y);
            asperity_put(goes, from[1], r[0]);
            asperity_put(goes, from[2], r[1]);
            size = asperity_root(step[1] * step[1] + step[2] * step[2]);
            size = asperity_choose(size > bound, bound / size, asperity_all(1.0));
            asperity_put(goes, step[1], step[1] * size);
            asperity_put(goes, step[2], step[2] * size);
        }
        if (!asperity_any(active)) {
            return found;
        }
        goes = active & asperity_not(anew);
        asperity_put(goes, *y, from[0] + step[0]);
        asperity_put(goes, r[0], from[1] + step[1]);
        asperity_put(goes, r[1], from[2] + step[2]);
    }
}

/* The yield factor from which it grows: that of the start, or the one that F_N and the yield force would have there. The ratio r becomes that of the start, where there is one:
 * a better guess than the trial's for what flows on. Returns the yield factor there. */
ASPERITY_FN asperity_v asperity_grow_from(asperity_step *p, asperity_v softening, asperity_v factor, asperity_cell *cells, asperity_v r[2]) {
    const asperity_work *s = p->s;
    asperity_v before = p->kept * (1.0 - s->softened) * (1.0 - softening * s->released * s->released) * p->row.force / p->f_n, at = factor;
    asperity_m held = p->old_f_n > 0.0;
    p->growing = asperity_all(1.0);
    p->growing_slope = asperity_all(0.0);
    if (asperity_any(held)) {
        asperity_put(held, r[0], p->old_f_t[0] / p->old_f_n);
        asperity_put(held, r[1], p->old_f_t[1] / p->old_f_n);
        at = asperity_choose(held, asperity_factor_at(p, r, cells), factor);
        p->growing = asperity_choose(held, at, p->growing);
    }
    p->rises = factor > p->growing;
    held = before > p->growing * (1.0 + 1e-10); /* where h stays they are the same, and rounding is not to choose its slope */
    p->growing = asperity_choose(held, before, p->growing);
    p->growing_slope = asperity_choose(held, -before * p->row.value[ASPERITY_GAMMA] / p->e, p->growing_slope);
    return at;
}

/* The sliders' exponent when it is sheared so far. */
ASPERITY_FN asperity_v asperity_sliders_n(const asperity_step *p, asperity_v worn) {
    return asperity_exponent(asperity_column(p->t, &p->row, ASPERITY_FIRST_N), asperity_column(p->t, &p->row, ASPERITY_UNSHEARED_N), (double)p->t->later, worn);
}

/* How far it was sheared and its slip reversed, as this step goes on from there: it follows r over a little way of d or F_N, and a press takes it back. A step that goes nowhere
 * leaves it, and with it the sliders. Slopes by h and d, for the tangent. */
ASPERITY_FN void asperity_wear(asperity_step *p) {
    const asperity_v *vertex = p->s->vertex;
    asperity_v gamma = p->row.value[ASPERITY_GAMMA], rate = p->row.dent_slope, none = asperity_all(0.0), one = asperity_all(1.0), per, r[2], size, turned, to, length, back;
    asperity_m held = p->old_f_n > 0.0, moves;
    p->worn = p->s->worn;
    p->worn_by[0] = p->worn_by[1] = p->worn_by[2] = none;
    if (!asperity_any(held)) {
        return;
    }
    per = p->per_friction / asperity_choose(held, p->old_f_n, one);
    r[0] = p->old_f_t[0] * per;
    r[1] = p->old_f_t[1] * per;
    size = p->twisted * p->per_friction / ASPERITY_TWIST_YIELD;
    turned = asperity_size(size) * ASPERITY_TWIST_WORN;
    turned = asperity_choose(turned < ASPERITY_TWIST_MOST, turned, asperity_all(ASPERITY_TWIST_MOST));
    size = asperity_root(r[0] * r[0] + r[1] * r[1] + size * size);
    size = asperity_choose(size < 1.0, size, one);
    to = asperity_choose(p->worn > size, p->worn, size);
    to = asperity_choose(to > turned, to, turned);
    back = -(r[0] * vertex[0] + r[1] * vertex[1]);
    moves = held & (back > 0.0);
    if (asperity_any(moves)) { /* slip against the vertex of a contact that was sheared */
        asperity_v sheared = asperity_choose(to < 1.0, to, one), reversed;
        length = asperity_choose(moves, asperity_root(vertex[0] * vertex[0] + vertex[1] * vertex[1]), one);
        back = asperity_choose(back < length, back / length, one);
        reversed = sheared + (2.0 - sheared) * sheared * sheared * sheared * sheared * back * back * length / (length + 0.02 * p->friction);
        to = asperity_choose(moves & asperity_not(to > reversed), reversed, to);
    }
    moves = held & (to > p->worn);
    if (asperity_any(moves)) {
        asperity_v k = per / ASPERITY_FOLLOWS, turn = ASPERITY_TWISTS(p) ? p->twist->along : none, d = asperity_root(p->d[0] * p->d[0] + p->d[1] * p->d[1] + turn * turn);
        asperity_v kd = p->row.stiff * k, kn = asperity_choose(p->f_n < p->old_f_n, -k, k) * p->friction;
        asperity_v left = asperity_exponential_near(-kd * d - kn * (p->f_n - p->old_f_n)), slope = (to - p->worn) * left;
        asperity_m slides = moves & (d > 0.0);
        p->worn = asperity_choose(moves, to - slope, p->worn);
        p->worn_by[0] = asperity_choose(moves & (p->e > 0.0), slope * kn * gamma * p->f_n / p->e, none);
        p->worn_by[1] = asperity_choose(slides, slope * kd * p->d[0] / d, none);
        p->worn_by[2] = asperity_choose(slides, slope * kd * p->d[1] / d, none);
    }
    moves = held & (p->worn > size) & (p->e > p->s->reach);
    if (asperity_any(moves)) {
        asperity_v per_pressed = ASPERITY_FORGETS / p->approach * rate / (rate + p->row.approach_slope + 1e-12);
        asperity_v pressed = asperity_choose(moves, asperity_exponential_near((p->s->reach - p->e) * per_pressed), one);
        p->worn = asperity_choose(moves, size + (p->worn - size) * pressed, p->worn);
        p->worn_by[0] = asperity_choose(moves, p->worn_by[0] * pressed - (p->worn - size) * per_pressed, p->worn_by[0]);
        p->worn_by[1] *= pressed;
        p->worn_by[2] *= pressed;
    }
}

/* What is released of F_N: how much the sliders carry (eta, its slope by h), and what that takes of the yield force. Returns the greatest share so far. */
ASPERITY_FN asperity_v asperity_release(asperity_step *p, asperity_v softening, asperity_guess *o) {
    const asperity_work *s = p->s;
    asperity_v gamma = p->row.value[ASPERITY_GAMMA], exponent = asperity_sliders_n(p, p->worn), released = s->released, none = asperity_all(0.0), share = none;
    asperity_m touches = p->e > 0.0, back = p->e < s->reach, more;
    asperity_lost(exponent, p->lost);
    p->per_exponent = 1.0 / exponent;
    o->eta = asperity_all(1.0);
    o->eta_h = o->log_share = p->rho_slope = none;
    if (asperity_any(back)) {
        asperity_m holds = back & touches;
        o->log_share = asperity_choose(back, asperity_choose(touches, gamma * asperity_logarithm(p->e / s->reach), asperity_all(-1e9)), none);
        o->eta = asperity_choose(holds, asperity_exponential(o->log_share / exponent), o->eta);
        o->eta_h = asperity_choose(holds, o->eta * gamma / (exponent * p->e), none);
        more = back & (-o->log_share > released); /* else the share released is less, too */
        if (asperity_any(more)) {
            share = asperity_choose(touches, asperity_exponential(o->log_share), none);
            more = more & (1.0 - share > released);
            released = asperity_choose(more, 1.0 - share, released);
            p->rho_slope = asperity_choose(more & touches, (1.0 - s->softened) * 2.0 * softening * released * gamma * share / p->e, none);
        }
    }
    p->rho = (1.0 - s->softened) * (1.0 - softening * released * released);
    return released;
}

#if !ASPERITY_SEVERAL
/* Slopes of the forces of an elastic step, by h and d. */
ASPERITY_FN void asperity_elastic_slopes(const asperity_step *p, asperity_guess *ASPERITY_ALONE o) {
    double rise = p->row.value[ASPERITY_GAMMA] / p->e, opens[2], by_worn[2];
    int j;
    asperity_slide_slopes(p, p->row.stiff, o);
    asperity_eta_slopes(p, o, opens);
    asperity_worn_slopes(p, o, by_worn);
    o->tangent[0][0] = o->f_n * rise;
    o->tangent[1][0] = o->tangent[2][0] = 0.0;
    for (j = 0; j < 2; j++) {
        o->tangent[0][1 + j] = o->wider[j] * rise + opens[j] * o->eta_h + by_worn[j] * p->worn_by[0];
        o->tangent[1][1 + j] = o->m[j] + by_worn[j] * p->worn_by[1];
        o->tangent[2][1 + j] = o->m[j + 1] + by_worn[j] * p->worn_by[2];
    }
}

/* A root between two places, by the secant; of a side that stays the excess is halved (the Illinois method). */
typedef struct asperity_between {
    double low, high, at_low, at_high; /* the excess is above 0 at `low`, below 0 at `high` */
    int side;
} asperity_between;

ASPERITY_FN double asperity_secant(const asperity_between *b) {
    return b->high - b->at_high * (b->high - b->low) / (b->at_high - b->at_low);
}

ASPERITY_FN void asperity_narrow(asperity_between *b, double place, double excess) {
    if (excess > 0.0) {
        b->low = place;
        b->at_low = excess;
        b->at_high *= b->side == 1 ? 0.5 : 1.0;
        b->side = 1;
    } else {
        b->high = place;
        b->at_high = excess;
        b->at_low *= b->side == -1 ? 0.5 : 1.0;
        b->side = -1;
    }
}

/* The answer at a guess of a bracket. */
ASPERITY_FN int asperity_counted(const asperity_step *p, double y, const double r[2], asperity_guess *ASPERITY_ALONE o) {
    o->tries -= o->tries > 0;
    return asperity_evaluate(p, y, r, o);
}

/* What the ratio lacks, along e, at a way s from r. */
ASPERITY_FN double asperity_along(const asperity_step *p, double y, const double r[2], const double e[2], double s, asperity_guess *ASPERITY_ALONE o) {
    double at[2];
    at[0] = r[0] + s * e[0];
    at[1] = r[1] + s * e[1];
    return asperity_counted(p, y, at, o) ? o->residual[1] * e[0] + o->residual[2] * e[1] : -1.0;
}

/* The way from r along e to the first ratio that lacks nothing; of r it lacks `size`. Flow that fades at full slip may leave several, and a slower step would come to the first. */
ASPERITY_FN double asperity_way(const asperity_step *p, double y, const double r[2], const double e[2], double size, asperity_guess *ASPERITY_ALONE o) {
    double greatest = p->friction * ASPERITY_SHORT, s;
    asperity_between b = {0.0, 0.0, size, size, 0};
    int k;
    for (k = 0; k < 400 && b.at_high > 0.0; k++) {
        double step = 0.2 * b.at_high < greatest ? 0.2 * b.at_high : greatest;
        b.low = b.high;
        b.at_low = b.at_high;
        b.high += step > 0.05 * greatest ? step : 0.05 * greatest;
        b.at_high = asperity_along(p, y, r, e, b.high, o);
    }
    s = b.high;
    for (k = 0; k < 40 && b.high - b.low > 1e-14; k++) {
        double here;
        s = k < 20 ? asperity_secant(&b) : 0.5 * (b.low + b.high);
        here = asperity_along(p, y, r, e, s, o);
        if (fabs(here) < 0.1 * ASPERITY_TOLERANCE || fabs(here) < 1e-3 * size) {
            break;
        }
        asperity_narrow(&b, s, here);
    }
    return s;
}

/* What F_N G has over the yield force at a hardening, for the ratio that belongs to it, looked for from that of the start: by Newton's steps where they bring it much nearer, else along
 * what it lacks. */
ASPERITY_FN double asperity_excess(const asperity_step *p, double y, const double start[2], asperity_guess *ASPERITY_ALONE o) {
    double r[2] = {start[0], start[1]}, short_of = p->friction * ASPERITY_SHORT, lacks[2], x[3], to[2], size, s;
    int k;
    for (k = 0; k < 50; k++) {
        if (!asperity_counted(p, y, r, o)) {
            return -1.0;
        }
        lacks[0] = o->residual[1];
        lacks[1] = o->residual[2];
        size = sqrt(lacks[0] * lacks[0] + lacks[1] * lacks[1]);
        if (size < ASPERITY_TOLERANCE) {
            return o->residual[0];
        }
        if (o->tries == 0) {
            break;
        }
        if (k > 0) {
            asperity_guess_slopes(p, 3, 1, o);
            x[1] = x[2] = 0.0;
            asperity_solve_at(o, 1, 0.0, x);
            to[0] = r[0] + x[1];
            to[1] = r[1] + x[2];
            if (x[1] * x[1] + x[2] * x[2] < short_of * short_of && asperity_counted(p, y, to, o) &&
                o->residual[1] * o->residual[1] + o->residual[2] * o->residual[2] < 0.04 * size * size) {
                r[0] = to[0];
                r[1] = to[1];
                continue;
            }
        }
        lacks[0] /= size;
        lacks[1] /= size;
        s = asperity_way(p, y, r, lacks, size, o);
        r[0] += s * lacks[0];
        r[1] += s * lacks[1];
    }
    /* Slowly from the start, where that comes to no end: there is an answer, as no ratio is beyond mu. */
    r[0] = start[0];
    r[1] = start[1];
    for (k = 0; k < 600; k++) {
        if (!asperity_counted(p, y, r, o)) {
            return -1.0;
        }
        if (!(o->residual[1] * o->residual[1] + o->residual[2] * o->residual[2] > 1e-20) || o->tries == 0) {
            return o->residual[0];
        }
        r[0] += 0.05 * o->residual[1];
        r[1] += 0.05 * o->residual[2];
    }
    return asperity_counted(p, y, r, o) ? o->residual[0] : -1.0;
}

/* The hardening, where Newton does not find the way: r is solved for at each, and what F_N G has over the yield force falls from above zero at 0 to below it. */
ASPERITY_FN double asperity_bracket(const asperity_step *p, double guess, const double r[2], asperity_guess *ASPERITY_ALONE o) {
    double most = asperity_most(p), y;
    asperity_between b;
    int k;
    b.low = 0.0;
    b.at_low = asperity_excess(p, b.low, r, o);
    if (!(b.at_low > 0.0)) {
        return b.low;
    }
    b.high = guess > 1e-3 * most ? guess : 1e-3 * most;
    b.at_high = asperity_excess(p, b.high, r, o);
    b.side = 0;
    while (b.at_high > 0.0 && b.high < most && o->tries > 0) {
        b.low = b.high;
        b.at_low = b.at_high;
        b.high = 4.0 * b.high < most ? 4.0 * b.high : most;
        b.at_high = asperity_excess(p, b.high, r, o);
    }
    y = b.high;
    for (k = 0; k < ASPERITY_BRACKETS && b.at_low > 0.0 && b.at_high < 0.0 && b.high - b.low > 1e-15 * p->depth && o->tries > 0; k++) {
        double here;
        y = asperity_secant(&b);
        here = asperity_excess(p, y, r, o);
        if (fabs(here) < ASPERITY_TOLERANCE) {
            break;
        }
        asperity_narrow(&b, y, here);
    }
    return y;
}

/* Slopes by it of each slider's share of what all carry, for the tangent. */
ASPERITY_FN void asperity_wear_slopes(asperity_step *p, const asperity_guess *o) {
    const double less = -1e-6;
    double lost[ASPERITY_CELLS], limit[ASPERITY_CELLS], n = asperity_sliders_n(p, p->worn + less), sum;
    int i;
    asperity_lost(n, lost);
    sum = asperity_limits(lost, o->log_share < 0.0 ? asperity_exponential(o->log_share / n) : 1.0, limit);
    for (i = 0; i < ASPERITY_CELLS; i++) {
        p->share_worn[i] = (limit[i] / sum - o->limit[i] / o->sum) / less;
    }
}

/* Slopes of the forces by h and d along the solution. */
ASPERITY_FN void asperity_solution_slopes(const asperity_step *p, asperity_guess *ASPERITY_ALONE o) {
    int j;
    asperity_guess_slopes(p, 6, 1, o);
    for (j = 0; j < 3; j++) {
        double x[3] = {0.0, 0.0, 0.0};
        asperity_solve(o, o->by[3 + j], x);
        o->tangent[j][0] = o->n_by[3 + j] + o->n_by[0] * x[0] + o->n_by[1] * x[1] + o->n_by[2] * x[2];
        o->tangent[j][1] = o->t_by[3 + j][0] + o->t_by[0][0] * x[0] + o->t_by[1][0] * x[1] + o->t_by[2][0] * x[2];
        o->tangent[j][2] = o->t_by[3 + j][1] + o->t_by[0][1] * x[0] + o->t_by[1][1] * x[1] + o->t_by[2][1] * x[2];
    }
}
#endif

/* One step. What was stored and done before is left in p. Returns of which contacts the answer was found; of none that yields where `what` is ASPERITY_ELASTIC. */
ASPERITY_FN asperity_m asperity_move(
    const asperity_table *t, const asperity_work *s, const asperity_twist *twist, asperity_v h, const asperity_v d[2], int what, asperity_step *p, asperity_work *next,
    asperity_guess *ASPERITY_ALONE o) {
    asperity_v softening, released, r[2], start[2], trial[2], y, guess, gamma, load, trial_load, factor, elastic[5], none = asperity_all(0.0);
    asperity_m touches, flows, found, hinted;
    int i;
    p->twist = twist;
    asperity_prepare(t, s, h, d, p);
    asperity_wear(p);
    gamma = p->row.value[ASPERITY_GAMMA];
    softening = asperity_column(t, &p->row, ASPERITY_SOFTENING);
    released = asperity_release(p, softening, o);
    o->friction = o->factor = o->unsolved = none;
    touches = asperity_elastic(p, o);
    r[0] = asperity_choose(touches, o->f_t[0] / o->f_n, none);
    r[1] = asperity_choose(touches, o->f_t[1] / o->f_n, none);
    load = asperity_choose(touches, o->f_n / p->row.force, none);
#if ASPERITY_SEVERAL
    flows = touches;
    memset(o->cell, 0, sizeof o->cell);
    for (i = 0; i < ASPERITY_SHAPES; i++) {
        o->cell[i].at = asperity_nowhere();
    }
#else
    flows = touches && !(load * asperity_most_factor(t, &p->row, p->friction) <= p->rho * p->kept);
#endif
    if (asperity_any(flows)) {
        o->factor = asperity_choose(flows, asperity_factor_at(p, r, o->cell), none);
        flows &= asperity_not(load * o->factor <= p->rho * p->kept * (1.0 + 1e-11));
    }
    o->plastic = flows;
    if (ASPERITY_SEVERAL || !asperity_any(flows)) {
#if !ASPERITY_SEVERAL
        memset(o->tangent, 0, sizeof o->tangent);
        if (what == ASPERITY_SLOPES && touches) {
            asperity_wear_slopes(p, o);
            asperity_elastic_slopes(p, o);
        }
#endif
        o->stored = asperity_choose(touches, o->f_n * o->e / (gamma + 1.0) + asperity_slider_energy(o->slider[0], o->slider[1], p->row.stiff), none);
        o->stiffness = asperity_choose(touches, gamma * o->f_n / o->e, none);
        asperity_keep(p, o, ASPERITY_EVERY, asperity_not(ASPERITY_EVERY), none, s->softened, released, next);
        if (what == ASPERITY_ELASTIC || !asperity_any(flows)) {
            return asperity_not(flows);
        }
    }
    elastic[0] = o->f_n;
    elastic[1] = o->f_t[0];
    elastic[2] = o->f_t[1];
    elastic[3] = o->stored;
    elastic[4] = o->stiffness;
    p->radial = asperity_column(t, &p->row, ASPERITY_RADIAL_SLIP);
    p->sudden = asperity_column(t, &p->row, ASPERITY_SUDDEN);
    memcpy(trial, r, sizeof trial);
    trial_load = load * o->factor;
    factor = asperity_grow_from(p, softening, o->factor, o->cell, r);
    p->rho_log = asperity_choose(p->rho < 1.0 - 1e-12, -1.0 / asperity_logarithm(p->rho), none);
    p->sum = asperity_limits(p->lost, asperity_all(1.0), p->limit);
    y = guess = asperity_first_guess(p, load * factor);
    start[0] = r[0];
    start[1] = r[1];
    hinted = asperity_hinted(p, trial, trial_load, &y, r);
    found = asperity_newton(p, flows, &y, r, o);
#if ASPERITY_SEVERAL
    (void)hinted;
#else
    if (!found && hinted) {
        y = guess;
        r[0] = start[0];
        r[1] = start[1];
        found = asperity_newton(p, flows, &y, r, o);
    }
    if (!found) {
        o->tries = ASPERITY_GUESSES < o->left ? ASPERITY_GUESSES : o->left;
        o->left -= o->tries;
        y = asperity_bracket(p, guess, start, o);
        o->left += o->tries;
        load = sqrt(o->residual[0] * o->residual[0] + o->residual[1] * o->residual[1] + o->residual[2] * o->residual[2]);
        o->unsolved = load <= 1e-7 ? 0.0 : load;
        found = p->last || load <= 1e-7;
    }
    if (what == ASPERITY_SLOPES) {
        asperity_wear_slopes(p, o);
        asperity_solution_slopes(p, o);
    }
#endif
    gamma = o->row.value[ASPERITY_GAMMA];
    load = asperity_slider_energy(o->slider[0], o->slider[1], o->row.stiff);
    o->stored = o->f_n * o->e / (gamma + 1.0) + load;
    o->friction = 0.5 * ((p->old_f_t[0] + o->f_t[0]) * o->move[0] + (p->old_f_t[1] + o->f_t[1]) * o->move[1]) - (load - p->old_stored[1]);
    o->stiffness = gamma * o->f_n / o->e;
    load = 1.0 - o->rho;
    released = none;
    touches = o->reach > o->e;
    if (asperity_any(touches)) { /* what is still released: so a next step that goes nowhere finds the same */
        softening = asperity_column(t, &o->row, ASPERITY_SOFTENING);
        released = asperity_choose(touches, 1.0 - asperity_exponential(gamma * asperity_logarithm(o->e / o->reach)), none);
        guess = 1.0 - o->rho / (1.0 - softening * released * released);
        load = asperity_choose(touches, asperity_choose(guess > 0.0, guess, none), load);
    }
    touches = o->e > 0.0; /* the last guess may be without contact: a shear may harden until nothing of h is elastic */
    load = asperity_choose(touches, load, s->softened);
    released = asperity_choose(touches, released, asperity_all(1.0));
    asperity_keep(p, o, flows, flows, y, load, released, next);
    asperity_keep_hint(p, flows, y, o->r, start, next);
    if (ASPERITY_SEVERAL) {
        o->f_n = asperity_choose(flows, o->f_n, elastic[0]);
        for (i = 0; i < 2; i++) {
            o->f_t[i] = asperity_choose(flows, o->f_t[i], elastic[1 + i]);
        }
        o->stored = asperity_choose(flows, o->stored, elastic[3]);
        o->stiffness = asperity_choose(flows, o->stiffness, elastic[4]);
    }
    return found | asperity_not(flows);
}

/* Forces and energies of a step over E R^2 and E R^3: what was dissipated, and of it by slip; and what is left of a step that was not solved. */
typedef struct asperity_account {
    asperity_v f_n, f_t[2], stored, stiffness, total, slip, unsolved;
} asperity_account;

/* Adds a step. What was done (by the mean of the forces before and after) and is not stored: the sliders' share is friction's, all of it in an elastic step; the rest plastic flow's. */
ASPERITY_FN void asperity_account_for(const asperity_step *p, const asperity_guess *o, asperity_account *a) {
    asperity_v total = 0.5 * ((p->old_f_n + o->f_n) * (p->h - p->s->h) + (p->old_f_t[0] + o->f_t[0]) * p->d[0] + (p->old_f_t[1] + o->f_t[1]) * p->d[1]);
    asperity_v slip = asperity_choose(o->friction > 0.0, o->friction, asperity_all(0.0));
    total -= o->stored - (p->old_stored[0] + p->old_stored[1]);
    total = asperity_choose(asperity_not(o->f_n > 0.0) & (total < 0.0), asperity_all(0.0), total); /* contact was lost within the step */
    a->total += total;
    a->slip += asperity_choose(asperity_not(o->plastic) | (total < 0.0) | (o->friction > total), total, slip);
    a->f_n = o->f_n;
    a->f_t[0] = o->f_t[0];
    a->f_t[1] = o->f_t[1];
    a->stored = o->stored;
    a->stiffness = o->stiffness;
    a->unsolved = asperity_choose(o->unsolved > a->unsolved, o->unsolved, a->unsolved);
}
