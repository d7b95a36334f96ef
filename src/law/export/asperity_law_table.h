/* ---- set-up: the table, of a sphere with R = 1 and E = 1 ---- */

#define ASPERITY_TABLE_NU @NU@
#define ASPERITY_TABLE_FRICTION @FRICTION@
#define ASPERITY_TABLE_MODULUS @MODULUS@ /* E*, over E */
#define ASPERITY_TABLE_LOG_FIRST @LOG_FIRST@
#define ASPERITY_TABLE_LOG_STEP @LOG_STEP@
#define ASPERITY_TABLE_DEEPEST @DEEPEST@ /* h/R */
#define ASPERITY_TABLE_HARDENING @HARDENING@
#define ASPERITY_TABLE_PAIRS @PAIRS@ /* of plastic strain and stress, where the hardening law is a table */

/* Whether two numbers are the same but for rounding. */
static inline int asperity_alike(double a, double b) {
    double size = fabs(a) > fabs(b) ? fabs(a) : fabs(b);
    return fabs(a - b) <= 1e-9 * size;
}

/* Whether `m` is the material of the table, in whatever units. A hardening table that is given without its points is taken for the right one. */
static inline int asperity_is_the_material(const asperity_material *m) {
    static const double numbers[3] = {@NUMBERS@}; /* stresses over E */
    static const int stress[3] = {@STRESSES@};
    static const double points[2 * ASPERITY_TABLE_PAIRS + 1] = {@POINT_LIST@0.0};
    int i;
    if (m->hardening != ASPERITY_TABLE_HARDENING || !asperity_alike(m->poissons_ratio, ASPERITY_TABLE_NU)) {
        return 0;
    }
    for (i = 0; i < 3; i++) {
        if (!asperity_alike(m->hardening_numbers[i], stress[i] ? numbers[i] * m->youngs_modulus : numbers[i])) {
            return 0;
        }
    }
    if (m->hardening != ASPERITY_TABLE || !m->points) {
        return 1;
    }
    if (m->point_count != ASPERITY_TABLE_PAIRS) {
        return 0;
    }
    for (i = 0; i < ASPERITY_TABLE_PAIRS; i++) {
        if (!asperity_alike(m->points[2 * i], points[2 * i]) || !asperity_alike(m->points[2 * i + 1], points[2 * i + 1] * m->youngs_modulus)) {
            return 0;
        }
    }
    return 1;
}

/* The parameters of a sphere of the radius `radius`. Returns 0; 1 if a number is out of its range, 4 if the material is not that of the table, 5 if the friction is
 * not: then `p` is not to be used. */
static inline int asperity_setup(asperity_parameters *p, const asperity_material *m, double radius, double friction) {
    static const double table[ASPERITY_KNOTS][ASPERITY_COLUMNS] = {
@ROWS@    };
    static const double shapes[ASPERITY_LEVELS][2][ASPERITY_POINTS] = {
@SHAPES@    };
    double e = m->youngs_modulus, length, force, stiffness;
    int i;
    if (!(e > 0.0 && radius > 0.0)) {
        return 1;
    }
    if (!asperity_is_the_material(m)) {
        return 4;
    }
    if (!asperity_alike(friction, ASPERITY_TABLE_FRICTION)) {
        return 5;
    }
    length = log(radius);
    force = log(e * radius * radius);
    stiffness = log(e * radius);
    p->radius = radius;
    p->effective_modulus = ASPERITY_TABLE_MODULUS * e;
    p->friction = ASPERITY_TABLE_FRICTION;
    p->log_first = ASPERITY_TABLE_LOG_FIRST + length;
    p->log_step = ASPERITY_TABLE_LOG_STEP;
    memcpy(p->table, table, sizeof table);
    memcpy(p->shapes, shapes, sizeof shapes);
    for (i = 0; i < ASPERITY_KNOTS; i++) {
        p->table[i][0] = p->table[i][0] + force;
        p->table[i][1] = p->table[i][1] + length;
        p->table[i][3] = p->table[i][3] + length;
        p->table[i][7] = p->table[i][7] + stiffness;
    }
    return 0;
}

/* What lies outside of the table at the indentation h > 0: a sum of 2 mu, 64 h/R, 128 another material. */
static inline int asperity_out_of_range(const asperity_material *m, double radius, double friction, double h) {
    int outside = 0;
    if (!asperity_alike(friction, ASPERITY_TABLE_FRICTION)) {
        outside |= 2;
    }
    if (!(h / radius <= ASPERITY_TABLE_DEEPEST * (1.0 + 1e-9))) {
        outside |= 64;
    }
    if (!asperity_is_the_material(m)) {
        outside |= 128;
    }
    return outside;
}
