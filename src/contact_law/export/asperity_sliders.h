/* Rows, shapes and sliders of the update: of one contact or, where asperity_v is several numbers, of as many contacts side by side. No guard: included once for each form. */

/* The memory in double, with lanes for the sliders. */
typedef struct asperity_work {
    asperity_v h, h_max, approach, hardened, reach, softened, released, worn, stiffened, vertex[2];
    asperity_v slider[3][ASPERITY_CELLS], hint[3];
} asperity_work;

/* A twist within a step: displacement at the contact's radius, what the memory holds of it, the ratio were nothing to flow, and by how much slip takes from it; and what a roll
 * leaves of the yield force and of the flow. */
typedef struct asperity_twist {
    asperity_v along, ratio, vertex, trial, gives, kept, flows;
    asperity_v sector[ASPERITY_SECTORS][2][ASPERITY_CELLS];
} asperity_twist;

/* A row of the table at a hardening depth, and its slopes; those of force and stiffness are of their logarithms. */
typedef struct asperity_row {
    asperity_v value[ASPERITY_SOLVED], slope[ASPERITY_SOLVED];
    asperity_v approach, approach_slope, dent, dent_slope; /* elastic approach D of first loading, and what is left of h */
    asperity_v wide, wide_slope; /* share of a growing yield factor that makes the contact stiffer: one that recovers all of its indentation has no dent that could grow instead */
    asperity_v force, stiff, share, share_slope; /* share: between the levels */
    asperity_v u;
    asperity_i level, at; /* before which level and row it is, u behind it, */
    asperity_v low[ASPERITY_KEPT], rise[ASPERITY_KEPT]; /* what stands there and how it goes on */
} asperity_row;

/* The values of a shape around a place: at it and behind it, on both levels. */
typedef struct asperity_cell {
    asperity_i at;
    asperity_v low[2], rise[2];
} asperity_cell;

/* Where a shape is read: after place j, and how far. */
typedef struct asperity_spot {
    asperity_i j;
    asperity_v u, per_width;
} asperity_spot;

/* What does not change within a step. */
typedef struct asperity_step {
    const asperity_table *t;
    const asperity_work *s;
    const asperity_twist *twist; /* or none */
    int last;                    /* whether it is not to be cut into parts, or more of them */
    asperity_row row; /* at its start */
    double friction, per_friction;
    asperity_v h, d[2], depth, per_depth, log_h, dent, approach; /* depth: h_m at its start, log_h of it over the first row's; approach: D there */
    asperity_v e, level, f_n, wide, log_wide;                    /* of the elastic trial, level: ln(e/D); wide: g at its start */
    asperity_v per_narrows;                                      /* 1 over the way on which a press makes it as wide as F_N has it */
    asperity_v worn, worn_by[3], share_worn[ASPERITY_CELLS];     /* how far sheared, slopes by h and d, and by it of a slider's share of what all carry */
    asperity_v radial, sudden, rho, rho_log, rho_slope, growing, growing_slope; /* slopes by h */
    asperity_v twisted, kept;                                    /* of the twist, over F_N; what a roll has left of the yield force */
    asperity_v axis[2], toward[2], trial; /* of a hint: the direction of r at the start, the way to the trial's ratio along and across it, and the hardening that the trial would bring */
    asperity_m rises;                                            /* whether the yield factor of the elastic trial is above the one from which it grows */
    asperity_v old_f_n, old_f_t[2], old_stored[2];               /* stored across and along the plane */
    asperity_v per_exponent, lost[ASPERITY_CELLS], limit[ASPERITY_CELLS], sum; /* of the sliders; the limits of a contact that is not released */
} asperity_step;

/* Everything at a guess of the hardening y and the ratio r. */
typedef struct asperity_guess {
    asperity_row row;
    asperity_cell cell[ASPERITY_SHAPES];
    asperity_v r[2], f_n, f_t[2], factor, rho, width, reach, hardens, vertex[2], residual[3], slip[2], friction, stored, stiffness, unsolved;
    asperity_m plastic;
    int tries, left; /* guesses that a bracket has left, and those of the step */
    asperity_v e, level, log_width, scale, move[3];
    asperity_v slider[3][ASPERITY_CELLS];
    /* Of a slider: its limit, its radial force and the square of all before they give way, whether it does, and the share of its force that it keeps. */
    asperity_v most[ASPERITY_CELLS], radially[ASPERITY_CELLS], squared[ASPERITY_CELLS], over[ASPERITY_CELLS], keep[ASPERITY_CELLS];
    asperity_m slips;
    /* Of the sliders: how much a contact carries that is released (the share that is whole, as a logarithm times gamma; slopes by y and h), and each one's share of it. */
    asperity_v eta, log_share, eta_y, eta_h, own[ASPERITY_CELLS], sum;
    const asperity_v *limit;
    /* Of plastic flow, and slopes by y, r and the factor. */
    asperity_v ratio, x[2], per_length, q, c, round, far, part[3], width_factor, width_y, rho_y, rho_h, mobile, mobile_r, grown, flow, flow_y, flow_r, sudden, sudden_y;
    asperity_v m[3], radial[2], stiffer[2], wider[2];
    asperity_v by[6][3], n_by[6], t_by[6][2]; /* of the residuals and the forces, by y, r, h, d */
    asperity_v tangent[3][3];                 /* of F_N and F_T, by h and d */
    /* Of the twist: forces, displacement, distance from the vertex, the vertex, slopes of F_T. */
    asperity_v sector[ASPERITY_SECTORS][2][ASPERITY_CELLS], turn, untwisted, twist_vertex, turned, per_turn, by_turn[2], pushed[2][ASPERITY_CELLS];
} asperity_guess;

/* The row, or the level, before a place; 0 to last. */
ASPERITY_FN asperity_i asperity_before(asperity_v x, int last) {
    asperity_v least = asperity_choose(x > 0.0, x, asperity_all(0.0));
    return asperity_whole(asperity_choose(least < (double)last, least, asperity_all((double)last)));
}

/* Finds a row. What stood there before is kept where it is the same. */
ASPERITY_FN void asperity_find_row(const asperity_table *t, asperity_v log_h, asperity_row *row) {
    asperity_v x = log_h * (double)t->per_step;
    asperity_i at = asperity_before(x, ASPERITY_ROWS - 2);
    int c;
    if (!ASPERITY_SEVERAL || asperity_any(at != row->at)) {
        row->at = at;
        asperity_gather_row(t->rows[0], at * (int)ASPERITY_COLUMNS, ASPERITY_KEPT, row->low);
        asperity_gather_row(t->rows[1], at * (int)ASPERITY_COLUMNS, ASPERITY_KEPT, row->rise);
        for (c = 0; c < ASPERITY_KEPT; c++) {
            row->rise[c] -= row->low[c];
        }
    }
    row->u = asperity_choose(x > 0.0, x - asperity_number(at), asperity_all(0.0));
}

/* The columns that are solved with, between the rows; force and stiffness still as logarithms. Beyond the last row only these two go on. */
ASPERITY_FN void asperity_read(const asperity_table *t, asperity_v depth, asperity_v log_h, asperity_row *row) {
    asperity_v u, v, level = (log_h - (double)t->level_start) * (double)t->per_level, per_depth = 1.0 / depth, per = (double)t->per_step * per_depth, plastic;
    asperity_m on;
    int c;
    asperity_find_row(t, log_h, row);
    u = row->u;
    on = u > 1.0;
    v = asperity_choose(on, asperity_all(1.0), u);
    for (c = 0; c < ASPERITY_SOLVED; c++) {
        if (c < ASPERITY_RECOVERED) {
            row->value[c] = row->low[c] + u * row->rise[c];
            row->slope[c] = row->rise[c] * per;
        } else {
            row->value[c] = row->low[c] + v * row->rise[c];
            row->slope[c] = asperity_choose(on, asperity_all(0.0), row->rise[c] * per);
        }
    }
    row->approach = row->value[ASPERITY_RECOVERED] * depth;
    row->approach_slope = row->value[ASPERITY_RECOVERED] + row->slope[ASPERITY_RECOVERED] * depth;
    row->dent = depth - row->approach;
    row->dent_slope = 1.0 - row->approach_slope;
    plastic = 1.0 - row->value[ASPERITY_RECOVERED];
    on = 2.0 * plastic < 1.0;
    row->wide = asperity_choose(on, 2.0 * plastic, asperity_all(1.0));
    row->wide_slope = asperity_choose(on, -2.0 * row->slope[ASPERITY_RECOVERED], asperity_all(0.0));
    row->level = asperity_before(level, ASPERITY_LEVELS - 2);
    u = level - asperity_number(row->level);
    row->share = asperity_choose(u > 0.0, asperity_choose(u < 1.0, u, asperity_all(1.0)), asperity_all(0.0));
    row->share_slope = asperity_choose((u >= 0.0) & (u < 1.0), (double)t->per_level * per_depth, asperity_all(0.0));
}

/* One of the other columns there. */
ASPERITY_FN asperity_v asperity_column(const asperity_table *t, const asperity_row *row, int column) {
    asperity_v low, rise;
    if (column < ASPERITY_KEPT) {
        low = row->low[column < ASPERITY_KEPT ? column : 0];
        rise = row->rise[column < ASPERITY_KEPT ? column : 0];
    } else {
        low = asperity_gather(&t->rows[0][column], row->at * (int)ASPERITY_COLUMNS);
        rise = asperity_gather(&t->rows[1][column], row->at * (int)ASPERITY_COLUMNS) - low;
    }
    return low + asperity_choose(row->u < 1.0, row->u, asperity_all(1.0)) * rise;
}

/* Where the shapes are read at x. */
ASPERITY_FN asperity_spot asperity_find(asperity_v x) {
    asperity_m inside = x < 1.0;
    asperity_v rest;
    asperity_spot at;
    at.j = asperity_before(asperity_choose(inside, ASPERITY_PLACES * (1.0 - asperity_root(1.0 - x)), asperity_all((double)ASPERITY_PLACES)), ASPERITY_PLACES - 1);
    rest = 1.0 - asperity_number(at.j) * (1.0 / ASPERITY_PLACES);
    at.per_width = asperity_choose(inside, ASPERITY_PLACES * ASPERITY_PLACES / (2.0 * ASPERITY_PLACES - 1.0 - 2.0 * asperity_number(at.j)), asperity_all(0.0));
    at.u = asperity_choose(inside, (x - (1.0 - rest * rest)) * at.per_width, asperity_all(1.0));
    return at;
}

/* A shape there: value, and slopes by x and by the share between levels. What was read around a place is kept in its cell. */
ASPERITY_FN asperity_v asperity_shape(const asperity_table *t, const asperity_row *row, int shape, asperity_spot spot, asperity_cell *cells, asperity_v slope[2]) {
    const asperity_real *low = &t->shapes[0][shape][0], *high = &t->shapes[1][shape][0];
    asperity_cell *cell = &cells[shape];
    asperity_i place = row->level * ((int)ASPERITY_SHAPES * (ASPERITY_PLACES + 1)) + spot.j;
    asperity_v a;
    if (!ASPERITY_SEVERAL || asperity_any(place != cell->at)) {
        cell->at = place;
        cell->low[0] = asperity_gather(low, place);
        cell->low[1] = asperity_gather(high, place);
        cell->rise[0] = asperity_gather(low + 1, place) - cell->low[0];
        cell->rise[1] = asperity_gather(high + 1, place) - cell->low[1];
    }
    a = cell->low[0] + spot.u * cell->rise[0];
    slope[0] = (cell->rise[0] + row->share * (cell->rise[1] - cell->rise[0])) * spot.per_width;
    slope[1] = cell->low[1] + spot.u * cell->rise[1] - a;
    return a + row->share * slope[1];
}

/* Approach, over that of the whole contact, at which each slider's annulus is lost, for the backbone 1 - (1 - x)^n (Jaeger). Cells end at (i/7)^(0.65/(n - 1)). */
ASPERITY_FN void asperity_lost(asperity_v n, asperity_v lost[ASPERITY_CELLS]) {
    static const double inside[ASPERITY_SLIDERS] = {0.282280072469456, 0.442952421594438, 0.5765240178913213, 0.6950706036696828, 0.8035649361350993, 0.9046677863757268, 0.9999999999999999};
    const double *per_weight = asperity_per_weights();
    asperity_v p = 0.65 / (n - 1.0), two = asperity_exponential(0.6931471805599453 * p), three = asperity_exponential(1.0986122886681098 * p);
    asperity_v five = asperity_exponential(1.6094379124341003 * p), seventh = asperity_exponential(-1.9459101490553132 * p), share = (n - 1.0) / n;
    asperity_v end[ASPERITY_SLIDERS];
    int i;
    end[0] = seventh * inside[0];
    end[1] = two * seventh * inside[1];
    end[2] = three * seventh * inside[2];
    end[3] = two * two * seventh * inside[3];
    end[4] = five * seventh * inside[4];
    end[5] = two * three * seventh * inside[5];
    end[6] = asperity_all(inside[6]);
    lost[0] = share * end[0] * per_weight[0];
    for (i = 1; i < ASPERITY_SLIDERS; i++) {
        lost[i] = share * (end[i] - end[i - 1]) * per_weight[i];
    }
    for (; i < ASPERITY_CELLS; i++) {
        lost[i] = asperity_all(2.0);
    }
}

/* Exponent of the backbone: of a contact that was not sheared, of its first reversal, of those after. */
ASPERITY_FN asperity_v asperity_exponent(asperity_v first, asperity_v unsheared, double later, asperity_v worn) {
    asperity_v rest = asperity_choose(worn < 1.0, 1.0 - worn, asperity_all(0.0));
    asperity_v reversed = asperity_choose(first > later, first + (worn - 1.0) * (later - first), first);
    return asperity_choose(worn <= 1.0, first + unsheared * rest * asperity_root(rest), reversed);
}

/* The yield factor at a ratio, whose spot is `at`, and a distance from the vertex. */
ASPERITY_FN asperity_v asperity_factor(const asperity_table *t, double per_friction, const asperity_row *row, asperity_spot at, asperity_v distance, asperity_cell *cells, asperity_v slope[3]) {
    asperity_v low = asperity_gather(t->reach, row->level), rise = asperity_gather(t->reach + 1, row->level) - low, per = 1.0 / (low + row->share * rise), x = distance * per, a[2], b[2];
    asperity_v lost = asperity_shape(t, row, ASPERITY_LOST, at, cells, a), more = asperity_shape(t, row, ASPERITY_VERTEX, asperity_find(x), cells, b);
    asperity_m beyond = x >= 1.0;
    if (asperity_any(beyond)) { /* the vertex goes on straight, by a share of its mean slope; the others stay */
        const asperity_real *last = &t->shapes[0][ASPERITY_VERTEX][ASPERITY_PLACES];
        asperity_i place = row->level * ((int)ASPERITY_SHAPES * (ASPERITY_PLACES + 1));
        asperity_v on = asperity_gather(last, place) * asperity_gather(t->beyond, row->level);
        asperity_v on_b = asperity_gather(last + ASPERITY_SHAPES * (ASPERITY_PLACES + 1), place) * asperity_gather(t->beyond + 1, row->level);
        b[0] = asperity_choose(beyond, on + row->share * (on_b - on), b[0]);
        b[1] = asperity_choose(beyond, b[1] + (on_b - on) * (x - 1.0), b[1]);
        more = asperity_choose(beyond, more + b[0] * (x - 1.0), more);
    }
    slope[0] = a[0] * per_friction;
    slope[1] = b[0] * per;
    slope[2] = (a[1] + b[1] - b[0] * x * rise * per) * row->share_slope; /* by depth */
    return 1.0 + lost + more;
}

/* No less than any yield factor at a row. */
ASPERITY_FN asperity_v asperity_most_factor(const asperity_table *t, const asperity_row *row, double friction) {
    asperity_v most = asperity_all(0.0);
    int k;
    for (k = 0; k <= 1; k++) {
        asperity_i i = row->level + k, place = i * ((int)ASPERITY_SHAPES * (ASPERITY_PLACES + 1));
        asperity_v over = 2.0 * friction / asperity_gather(t->reach, i) - 1.0, bound = asperity_gather(&t->shapes[0][ASPERITY_VERTEX][ASPERITY_PLACES], place);
        over = asperity_choose(over > 0.0, over * asperity_gather(t->beyond, i), asperity_all(0.0));
        bound = 1.0 + asperity_gather(&t->shapes[0][ASPERITY_LOST][ASPERITY_PLACES], place) + bound * (1.0 + over);
        most = asperity_choose(most > bound, most, bound);
    }
    return most;
}

/* The same at the start of a step. */
ASPERITY_FN asperity_v asperity_factor_at(const asperity_step *p, const asperity_v r[2], asperity_cell *cells) {
    asperity_v slope[3], x = r[0] - p->s->vertex[0], y = r[1] - p->s->vertex[1], m = p->twisted, z = ASPERITY_TWISTS(p) ? m - p->twist->vertex : asperity_all(0.0);
    return asperity_factor(p->t, p->per_friction, &p->row, asperity_find(asperity_root(r[0] * r[0] + r[1] * r[1] + m * m) * p->per_friction), asperity_root(x * x + y * y + z * z), cells, slope);
}

ASPERITY_FN asperity_v asperity_sum(const asperity_v x[ASPERITY_CELLS]) {
    return ((x[0] + x[2]) + (x[4] + x[6])) + ((x[1] + x[3]) + ASPERITY_LAST_TWO(x));
}

/* What each slider may carry at eta, over what all carry that are whole: the innermost carries what little force there is. Returns their sum by weight. */
ASPERITY_FN asperity_v asperity_limits(const asperity_v *ASPERITY_ALONE lost, asperity_v eta, asperity_v *ASPERITY_ALONE limit) {
    const double *weight = asperity_weights();
    asperity_v carried[ASPERITY_CELLS];
    int i;
    ASPERITY_LOOP
    for (i = 0; i < ASPERITY_CELLS; i++) {
        asperity_v x = eta - lost[i];
        limit[i] = asperity_choose(x > 0.0, x, asperity_all(0.0));
    }
    limit[0] = asperity_choose(limit[0] < 0.1 * eta, 0.1 * eta, limit[0]);
    ASPERITY_LOOP
    for (i = 0; i < ASPERITY_CELLS; i++) {
        carried[i] = weight[i] * limit[i];
    }
    return asperity_sum(carried);
}

/* Moves the sectors of the sliders of a contact that twists, each within the limit; a radial force is the same in all. With the slopes of their force. */
ASPERITY_FN void asperity_slide_sectors(const asperity_step *p, asperity_v stiff, asperity_guess *ASPERITY_ALONE o) {
    const double *weight = asperity_weights(), *lever = asperity_levers(), share = 1.0 / ASPERITY_SECTORS;
    int i, j, c;
    memset(o->by_turn, 0, sizeof o->by_turn);
    memset(o->m, 0, sizeof o->m);
    memset(o->radial, 0, sizeof o->radial);
    memset(o->stiffer, 0, sizeof o->stiffer);
    memset(o->wider, 0, sizeof o->wider);
    o->slips = ASPERITY_EVERY;
    for (i = 0; i < ASPERITY_CELLS; i++) {
        asperity_v k = stiff * weight[i], most = weight[i] * o->limit[i] * o->scale, bound = ASPERITY_RADIAL_MOST * most;
        asperity_v radially = p->s->slider[2][i] + k * o->move[2], radial = asperity_choose(radially < bound, radially, bound), left = asperity_all(1.0);
        asperity_m gives = radially > bound;
        double turn = ASPERITY_TWIST_STIFF * lever[i];
        o->most[i] = most;
        o->radially[i] = radially;
        o->slider[0][i] = o->slider[1][i] = o->pushed[0][i] = o->pushed[1][i] = asperity_all(0.0);
        for (j = 0; j < ASPERITY_SECTORS; j++) {
            const double *around = asperity_around(j);
            asperity_v d[2], f[2], square, keep, per, u[3], grows, moved;
            asperity_m slides;
            for (c = 0; c < 2; c++) {
                d[c] = o->move[c] + turn * o->turn * around[c];
                f[c] = p->twist->sector[j][c][i] + k * d[c];
            }
            square = f[0] * f[0] + f[1] * f[1] + radial * radial;
            slides = square > most * most;
            per = asperity_choose(slides, 1.0 / asperity_root(square), asperity_all(0.0));
            keep = asperity_choose(slides, most * per, asperity_all(1.0));
            u[0] = f[0] * per;
            u[1] = f[1] * per;
            u[2] = radial * per;
            left = asperity_choose(left < keep, left, keep);
            grows = asperity_choose(gives, 1.0 - keep * u[2] * ASPERITY_RADIAL_MOST, asperity_all(1.0));
            moved = u[0] * d[0] + u[1] * d[1] + asperity_choose(gives, asperity_all(0.0), u[2] * o->move[2]);
            k = keep * share * weight[i];
            o->m[0] += k * stiff * (1.0 - u[0] * u[0]);
            o->m[1] -= k * stiff * u[0] * u[1];
            o->m[2] += k * stiff * (1.0 - u[1] * u[1]);
            for (c = 0; c < 2; c++) {
                o->sector[j][c][i] = keep * f[c];
                o->slider[c][i] += share * keep * f[c];
                o->radial[c] -= asperity_choose(gives, asperity_all(0.0), k * stiff * u[c] * u[2]);
                o->stiffer[c] += k * (d[c] - u[c] * moved);
                o->pushed[c][i] += share * u[c] * grows;
                o->by_turn[c] += k * stiff * turn * (around[c] - u[c] * (u[0] * around[0] + u[1] * around[1]));
            }
            k = stiff * weight[i];
        }
        o->slider[2][i] = left * radial; /* what the sector that gives way most leaves, so that none is beyond its limit */
        for (c = 0; c < 2; c++) {
            o->wider[c] += o->pushed[c][i] * most;
        }
    }
    o->f_t[0] = asperity_sum(o->slider[0]);
    o->f_t[1] = asperity_sum(o->slider[1]);
}

/* Moves the sliders within their limits. Loops of their own: a compiler makes lanes of short ones. */
ASPERITY_FN void asperity_slide(const asperity_step *p, asperity_v stiff, asperity_guess *ASPERITY_ALONE o) {
    const double *weight = asperity_weights();
    const asperity_v *limit = o->limit, *f0 = p->s->slider[0], *f1 = p->s->slider[1], *f2 = p->s->slider[2];
    asperity_v scale = p->friction * o->f_n / o->sum, d0 = stiff * o->move[0], d1 = stiff * o->move[1], d2 = stiff * o->move[2];
    asperity_v *t0 = o->slider[0], *t1 = o->slider[1], *t2 = o->slider[2];
    int i;
    o->scale = scale;
    if (ASPERITY_TWISTS(p)) {
        asperity_slide_sectors(p, stiff, o);
        return;
    }
    ASPERITY_LOOP
    for (i = 0; i < ASPERITY_CELLS; i++) {
        o->most[i] = weight[i] * limit[i] * scale;
        t0[i] = f0[i] + weight[i] * d0;
        t1[i] = f1[i] + weight[i] * d1;
        o->radially[i] = f2[i] + weight[i] * d2;
        ASPERITY_NEXT
        t2[i] = asperity_choose(o->radially[i] < ASPERITY_RADIAL_MOST * o->most[i], o->radially[i], ASPERITY_RADIAL_MOST * o->most[i]);
        ASPERITY_NEXT
        o->squared[i] = t0[i] * t0[i] + t1[i] * t1[i] + t2[i] * t2[i];
        ASPERITY_NEXT
        o->over[i] = asperity_choose(o->squared[i] > o->most[i] * o->most[i], asperity_all(1.0), asperity_all(0.0));
    }
    o->slips = asperity_sum(o->over) > 0.0;
    if (ASPERITY_SEVERAL || asperity_any(o->slips)) {
        ASPERITY_LOOP
        for (i = 0; i < ASPERITY_CELLS; i++) {
            /* No sum: of a large step the share is below a last digit of 1. */
            asperity_v root = asperity_inverse_root(o->squared[i] + 1e-200), keep = asperity_choose(o->over[i] > 0.0, o->most[i] * root, asperity_all(1.0));
            o->keep[i] = keep;
            t0[i] *= keep;
            t1[i] *= keep;
            t2[i] *= keep;
        }
    }
    o->f_t[0] = asperity_sum(t0);
    o->f_t[1] = asperity_sum(t1);
}

/* Slopes of their force: by the displacement (m, radial), by the stiffness, by the limit. Those that stick have no direction of slip. */
ASPERITY_FN void asperity_slide_slopes(const asperity_step *p, asperity_v stiff, asperity_guess *ASPERITY_ALONE o) {
    const double *weight = asperity_weights();
    const asperity_v *t0 = o->slider[0], *t1 = o->slider[1], *t2 = o->slider[2];
    asperity_v sums[9][ASPERITY_CELLS], free[ASPERITY_CELLS], d0 = o->move[0], d1 = o->move[1], d2 = o->move[2];
    int i;
    (void)p;
    if (ASPERITY_TWISTS(p)) {
        return; /* those of the sectors are known */
    }
    o->by_turn[0] = o->by_turn[1] = asperity_all(0.0);
    if (!ASPERITY_SEVERAL && !asperity_any(o->slips)) {
        o->radial[0] = o->radial[1] = o->wider[0] = o->wider[1] = o->m[1] = asperity_all(0.0);
        o->m[0] = o->m[2] = stiff * ASPERITY_ALL_WEIGHTS;
        o->stiffer[0] = d0 * ASPERITY_ALL_WEIGHTS;
        o->stiffer[1] = d1 * ASPERITY_ALL_WEIGHTS;
        return;
    }
    ASPERITY_LOOP
    for (i = 0; i < ASPERITY_CELLS; i++) {
        asperity_v bound = ASPERITY_RADIAL_MOST * o->most[i], f = o->radially[i];
        free[i] = asperity_choose(f > bound, asperity_all(0.0), asperity_all(1.0));
    }
    ASPERITY_LOOP
    for (i = 0; i < ASPERITY_CELLS; i++) {
        asperity_v keep = o->keep[i], most = o->most[i], per = o->over[i] / (most + 1e-300), k = keep * weight[i];
        asperity_v u0 = per * t0[i], u1 = per * t1[i], u2 = per * t2[i];
        asperity_v along = most * (1.0 - keep * u2 * (1.0 - free[i]) * ASPERITY_RADIAL_MOST), moved = u0 * d0 + u1 * d1 + free[i] * u2 * d2;
        sums[0][i] = k * (1.0 - u0 * u0);
        sums[1][i] = k * u0 * u1;
        sums[2][i] = k * (1.0 - u1 * u1);
        sums[3][i] = k * free[i] * u0 * u2;
        sums[4][i] = k * free[i] * u1 * u2;
        sums[5][i] = k * (d0 - u0 * moved);
        sums[6][i] = k * (d1 - u1 * moved);
        sums[7][i] = u0 * along;
        sums[8][i] = u1 * along;
    }
    o->m[0] = stiff * asperity_sum(sums[0]);
    o->m[1] = -stiff * asperity_sum(sums[1]);
    o->m[2] = stiff * asperity_sum(sums[2]);
    for (i = 0; i < 2; i++) {
        o->radial[i] = -stiff * asperity_sum(sums[3 + i]);
        o->stiffer[i] = asperity_sum(sums[5 + i]);
        o->wider[i] = asperity_sum(sums[7 + i]);
    }
}

/* Slopes of the sliders' force by how far it was sheared. */
ASPERITY_FN void asperity_worn_slopes(const asperity_step *p, const asperity_guess *o, asperity_v by[2]) {
    const double *weight = asperity_weights();
    int i;
    by[0] = by[1] = asperity_all(0.0);
    for (i = 0; ASPERITY_TWISTS(p) && i < ASPERITY_SLIDERS; i++) {
        by[0] += o->pushed[0][i] * weight[i] * p->friction * o->f_n * p->share_worn[i];
        by[1] += o->pushed[1][i] * weight[i] * p->friction * o->f_n * p->share_worn[i];
    }
    for (i = 0; !ASPERITY_TWISTS(p) && i < ASPERITY_SLIDERS; i++) {
        asperity_m moves = o->slips & (o->over[i] > 0.0) & (o->most[i] > 0.0);
        if (asperity_any(moves)) {
            asperity_v held = asperity_choose(o->radially[i] > ASPERITY_RADIAL_MOST * o->most[i], asperity_all(ASPERITY_RADIAL_MOST), asperity_all(0.0));
            asperity_v along = (1.0 - o->keep[i] * o->slider[2][i] / o->most[i] * held) * weight[i] * p->friction * o->f_n * p->share_worn[i] / o->most[i];
            along = asperity_choose(moves, along, asperity_all(0.0));
            by[0] += o->slider[0][i] * along;
            by[1] += o->slider[1][i] * along;
        }
    }
}

/* Slopes of the sliders' force by eta. */
ASPERITY_FN void asperity_eta_slopes(const asperity_step *p, const asperity_guess *o, asperity_v by[2]) {
    const double *weight = asperity_weights();
    asperity_v opening[ASPERITY_SLIDERS], open = asperity_all(0.0);
    asperity_m released = o->slips & (o->eta < 1.0);
    int i;
    by[0] = by[1] = asperity_all(0.0);
    if (!asperity_any(released)) {
        return;
    }
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        opening[i] = asperity_choose(o->eta > p->lost[i], asperity_all(1.0), asperity_all(0.0));
        if (i == 0) {
            opening[i] = asperity_choose(o->eta - p->lost[0] < 0.1 * o->eta, asperity_all(0.1), opening[i]);
        }
        open += weight[i] * opening[i];
    }
    for (i = 0; ASPERITY_TWISTS(p) && i < ASPERITY_SLIDERS; i++) {
        by[0] += o->pushed[0][i] * weight[i] * o->scale * (opening[i] - o->limit[i] * open / o->sum);
        by[1] += o->pushed[1][i] * weight[i] * o->scale * (opening[i] - o->limit[i] * open / o->sum);
    }
    for (i = 0; !ASPERITY_TWISTS(p) && i < ASPERITY_SLIDERS; i++) {
        asperity_m moves = released & (o->over[i] > 0.0) & (o->most[i] > 0.0);
        if (asperity_any(moves)) {
            asperity_v held = asperity_choose(o->radially[i] > ASPERITY_RADIAL_MOST * o->most[i], asperity_all(ASPERITY_RADIAL_MOST), asperity_all(0.0));
            asperity_v along = (1.0 - o->keep[i] * o->slider[2][i] / o->most[i] * held) * weight[i] * o->scale * (opening[i] - o->limit[i] * open / o->sum) / o->most[i];
            along = asperity_choose(moves, along, asperity_all(0.0));
            by[0] += o->slider[0][i] * along;
            by[1] += o->slider[1][i] * along;
        }
    }
}

/* Elastic energy of the sliders. */
ASPERITY_FN asperity_v asperity_slider_energy(const asperity_v x[ASPERITY_CELLS], const asperity_v y[ASPERITY_CELLS], asperity_v stiff) {
    const double *per_weight = asperity_per_weights();
    asperity_v energy[ASPERITY_CELLS];
    int i;
    ASPERITY_LOOP
    for (i = 0; i < ASPERITY_CELLS; i++) {
        energy[i] = (x[i] * x[i] + y[i] * y[i]) * per_weight[i];
    }
    return 0.5 * asperity_sum(energy) / stiff;
}
