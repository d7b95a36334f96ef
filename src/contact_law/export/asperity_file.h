/* A table from its file. No guard: included once. */
#ifndef ASPERITY_NO_FILES
/* A number as the files have it, whatever the decimal point of the program's locale is. Whether there was one, and nothing else in the word. */
static inline int asperity_scan_number(FILE *file, asperity_real *value) {
    char word[48], local[64], *end, *dot;
    const char *point = localeconv()->decimal_point;
    double number;
    if (fscanf(file, "%47s", word) != 1) {
        return 0;
    }
    dot = strchr(word, '.');
    if (dot && strcmp(point, ".") != 0 && strlen(point) < sizeof local - sizeof word) {
        size_t before = (size_t)(dot - word), size = strlen(point);
        memcpy(local, word, before);
        memcpy(local + before, point, size);
        memcpy(local + before + size, dot + 1, strlen(dot + 1) + 1);
    } else {
        memcpy(local, word, sizeof word);
    }
    number = strtod(local, &end);
    *value = ASPERITY_R(number);
    return end != local && *end == '\0' && asperity_is_finite(*value);
}

/* One line "name value" of a table's file. */
static inline int asperity_scan_named(FILE *file, const char *name, asperity_real *value) {
    char found[32];
    return fscanf(file, "%31s", found) == 1 && strcmp(found, name) == 0 && asperity_scan_number(file, value);
}

static inline int asperity_scan_numbers(FILE *file, asperity_real *value, int count) {
    int i, good = 1;
    for (i = 0; good && i < count; i++) {
        good = asperity_scan_number(file, &value[i]);
    }
    return good;
}

static inline int asperity_scan_word(FILE *file, const char *word) {
    char found[32];
    return fscanf(file, "%31s", found) == 1 && strcmp(found, word) == 0;
}

static inline int asperity_is_within(asperity_real x, double least, double most) {
    return asperity_is_finite(x) && (double)x >= least && (double)x <= most;
}

/* Whether the numbers of a table are such that the update may count on them: n and gamma above 1, a dent that deepens, no loss below 0. */
static inline int asperity_is_sound_table(const asperity_table *t) {
    static const double least[ASPERITY_COLUMNS] = {-150.0, -150.0, 1e-30, 1.0 + 1e-3, 1.0 + 1e-3, 0.0, 0.0, 0.0, 0.0, -100.0};
    static const double most[ASPERITY_COLUMNS] = {30.0, 30.0, 1.0, 2.0, 100.0, 100.0, 100.0, 100.0, 0.999, 30.0};
    int i, j, k;
    int good = (t->plane == 0 || t->plane == 1) && asperity_is_within(t->share, 1e-6, 1e6) && asperity_is_within(t->poissons_ratio, -1.0, 0.5) &&
               asperity_is_within(t->friction, 0.0, 1e9) && asperity_is_within(t->effective_modulus, 1e-30, 1e30) && asperity_is_within(t->effective_radius, 1e-30, 1e30) &&
               asperity_is_within(t->deepest, 0.0, 10.0) && asperity_is_within(t->later, 1.0 + 1e-3, 100.0) && asperity_is_within(t->first, 1e-30, 10.0) &&
               asperity_is_within(t->per_step, 1e-3, 1e6) && asperity_is_within(t->level_start, 0.0, 100.0) && asperity_is_within(t->per_level, 1e-4, 1e6);
    for (i = 0; good && i < ASPERITY_ROWS; i++) {
        for (k = 0; good && k < ASPERITY_COLUMNS; k++) {
            good = asperity_is_within(t->rows[i][k], least[k], most[k]);
        }
        good = good && (i == 0 || t->rows[i][ASPERITY_RECOVERED] <= t->rows[i - 1][ASPERITY_RECOVERED]);
    }
    for (i = 0; good && i < ASPERITY_LEVELS; i++) {
        for (j = 0; good && j < ASPERITY_SHAPES; j++) {
            for (k = 0; good && k <= ASPERITY_PLACES; k++) {
                good = asperity_is_within(t->shapes[i][j][k], 0.0, 1e9);
            }
        }
        good = good && asperity_is_within(t->reach[i], 1e-12, 1e9) && asperity_is_within(t->beyond[i], 0.0, 1e6);
    }
    return good;
}

/* Reads a file that `asperity law export` wrote. Returns 0; 1: it cannot be opened, 2: it is no such file or of another version, 3: it is cut short, damaged, or has numbers that no law has. */
static inline int asperity_read_table(const char *path, asperity_table *t) {
    char body[32];
    int version, i, good;
    FILE *file = fopen(path, "r");
    memset(t, 0, sizeof *t);
    if (!file) {
        return 1;
    }
    if (fscanf(file, "asperity-contact-table %d body %31s", &version, body) != 2 || version != 5) {
        fclose(file);
        return 2;
    }
    t->plane = strcmp(body, "plane") == 0;
    good = asperity_scan_named(file, "share", &t->share) && asperity_scan_named(file, "poissons_ratio", &t->poissons_ratio) &&
           asperity_scan_named(file, "friction", &t->friction) && asperity_scan_named(file, "effective_modulus", &t->effective_modulus) &&
           asperity_scan_named(file, "effective_radius", &t->effective_radius) && asperity_scan_named(file, "deepest", &t->deepest) &&
           asperity_scan_named(file, "later", &t->later) && asperity_scan_named(file, "first", &t->first) && asperity_scan_named(file, "per_step", &t->per_step) &&
           asperity_scan_named(file, "level_start", &t->level_start) && asperity_scan_named(file, "per_level", &t->per_level) && asperity_scan_word(file, "rows");
    for (i = 0; good && i < ASPERITY_ROWS; i++) {
        good = asperity_scan_numbers(file, t->rows[i], ASPERITY_COLUMNS);
    }
    good = good && asperity_scan_word(file, "shapes");
    for (i = 0; good && i < ASPERITY_LEVELS * ASPERITY_SHAPES; i++) {
        good = asperity_scan_numbers(file, t->shapes[i / ASPERITY_SHAPES][i % ASPERITY_SHAPES], ASPERITY_PLACES + 1);
    }
    good = good && asperity_scan_word(file, "vertex");
    for (i = 0; good && i < ASPERITY_LEVELS; i++) {
        good = asperity_scan_number(file, &t->reach[i]) && asperity_scan_number(file, &t->beyond[i]);
    }
    good = good && asperity_scan_word(file, "end");
    fclose(file);
    return good && asperity_is_sound_table(t) ? 0 : 3;
}
#endif
