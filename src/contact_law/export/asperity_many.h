/* Many pairs of spheres. No guard: included once. */

/* Before the update of pairs in lanes. What twists and rolls goes through it here, one by one; of the others the increments are added to `several`. Returns how many. */
ASPERITY_FN int asperity_start_block(const asperity_law3d *law, asperity_real dt, int count, asperity_pair *pairs, asperity_block *m, asperity_increment *several) {
    int turning = pairs->turning != NULL, waiting = 0, l;
    for (l = 0; l < count; l++) {
        asperity_load_pair(pairs[l].i, pairs[l].j, l, m);
        m->axis[0][l] = pairs[l].before->axis[0];
        m->axis[1][l] = pairs[l].before->axis[1];
    }
    asperity_kinematics(law, count, m);
    asperity_increments(law, dt, count, turning, m);
    for (l = 0; l < count; l++) {
        m->flags[l] = asperity_unanswered(law, m->size[l]);
        if (m->flags[l]) {
            m->f_n[l] = m->f_t[0][l] = m->f_t[1][l] = m->stiffness[l] = m->stored[l] = m->plastic[l] = m->friction[l] = asperity_no_number();
        } else if (turning) {
            asperity_update_lane(law, &pairs[l].before->state, pairs[l].turning, pairs[l].turning, pairs[l].cohesion, l, m);
        } else {
            asperity_increment *one = &several[waiting++];
            one->state = &pairs[l].before->state;
            one->next = &m->state[l];
            one->radius = m->radius[l];
            one->h = m->h[l];
            one->d[0] = m->d[0][l];
            one->d[1] = m->d[1][l];
        }
    }
    return waiting;
}

/* After it, with the increments that were added. Returns how many. */
ASPERITY_FN int asperity_finish_block(const asperity_law3d *law, asperity_real dt, int count, asperity_pair *pairs, asperity_block *m, const asperity_increment *several) {
    int turning = pairs->turning != NULL, cohesion = pairs->cohesion != NULL, taken = 0, l;
    for (l = 0; l < count; l++) {
        if (!m->flags[l] && !turning) {
            const asperity_increment *one = &several[taken++];
            asperity_store_answer(&one->out, l, m);
            if (cohesion) {
                asperity_cohere(&law->cohesion, law->table, m->radius[l], law->modulus, one->state, one->next, pairs[l].cohesion, one->d, &m->joined[l], &m->pull[l]);
            }
        }
    }
    asperity_block_forces(law, dt, count, cohesion, m);
    for (l = 0; l < count; l++) {
        if (m->flags[l]) {
            asperity_no_answer(m->flags[l], pairs[l].before, pairs[l].after, &pairs[l].out);
        } else {
            asperity_store_lane(law, pairs[l].before, pairs[l].after, turning, pairs[l].cohesion, l, m, &pairs[l].out);
        }
    }
    return taken;
}

/* Many pairs of one law, each by itself; no two share a memory. All have twist and roll or none, and cohesion or none. */
ASPERITY_FN void asperity_spheres_many(const asperity_law3d *law, asperity_real dt, int count, asperity_pair *pairs) {
    asperity_block m[ASPERITY_BLOCKS];
    asperity_increment several[ASPERITY_BLOCKS * ASPERITY_TOGETHER];
    int k, at;
    for (; count > 0; count -= ASPERITY_BLOCKS * ASPERITY_TOGETHER, pairs += ASPERITY_BLOCKS * ASPERITY_TOGETHER) {
        for (k = 0, at = 0; k < ASPERITY_BLOCKS && count > k * ASPERITY_TOGETHER; k++) {
            int size = count - k * ASPERITY_TOGETHER < ASPERITY_TOGETHER ? count - k * ASPERITY_TOGETHER : ASPERITY_TOGETHER;
            at += asperity_start_block(law, dt, size, pairs + k * ASPERITY_TOGETHER, &m[k], several + at);
        }
        asperity_update_many(law->table, law->modulus, at, several);
        for (k = 0, at = 0; k < ASPERITY_BLOCKS && count > k * ASPERITY_TOGETHER; k++) {
            int size = count - k * ASPERITY_TOGETHER < ASPERITY_TOGETHER ? count - k * ASPERITY_TOGETHER : ASPERITY_TOGETHER;
            at += asperity_finish_block(law, dt, size, pairs + k * ASPERITY_TOGETHER, &m[k], several + at);
        }
    }
}
