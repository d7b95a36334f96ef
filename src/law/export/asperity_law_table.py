# ---- set-up: the table, of a sphere with R = 1 and E = 1 ----

TABLE_NU = @NU@
TABLE_FRICTION = @FRICTION@
TABLE_MODULUS = @MODULUS@  # E*, over E
TABLE_RADIUS = @RADIUS@  # R*, over R
TABLE_LOG_FIRST = @LOG_FIRST@
TABLE_LOG_STEP = @LOG_STEP@
TABLE_DEEPEST = @DEEPEST@  # h/R
TABLE_HARDENING = @HARDENING@
TABLE_NUMBERS = (@NUMBERS@)  # stresses over E
TABLE_STRESSES = (@STRESSES@)
TABLE_PAIRS = (@POINT_LIST@)
# fmt: off
TABLE_ROWS = (
@ROWS@)
TABLE_SHAPES = (
@SHAPES@)
# fmt: on


def alike(a, b):
    """Whether two numbers are the same but for rounding."""
    return abs(a - b) <= 1e-9 * max(abs(a), abs(b))


def is_the_material(m):
    """Whether `m` is the material of the table, in whatever units. A hardening table that is given without its points is taken for the right one."""
    if m.hardening != TABLE_HARDENING or not alike(m.poissons_ratio, TABLE_NU):
        return False
    numbers = [number * m.youngs_modulus if stress else number for number, stress in zip(TABLE_NUMBERS, TABLE_STRESSES)]
    if not all(alike(a, b) for a, b in zip(m.hardening_numbers, numbers)):
        return False
    given_points = [value for pair in m.points for value in pair]
    if not given_points:
        return True
    own = [value * m.youngs_modulus if i % 2 else value for i, value in enumerate(TABLE_PAIRS)]
    return len(own) == len(given_points) and all(alike(a, b) for a, b in zip(given_points, own))


def setup(m, radius, friction):
    """The parameters of a sphere of the radius `radius`; ValueError for a number out of its range, another material or another friction."""
    e = m.youngs_modulus
    if not (e > 0.0 and radius > 0.0):
        raise ValueError("give E > 0 and R > 0")
    if not is_the_material(m):
        raise ValueError("the table is of another material")
    if not alike(friction, TABLE_FRICTION):
        raise ValueError("the table is of mu = %r" % TABLE_FRICTION)
    length = math.log(radius)
    force = math.log(e * radius * radius)
    stiffness = math.log(e * radius)
    p = Parameters()
    p.radius = TABLE_RADIUS * radius
    p.effective_modulus = TABLE_MODULUS * e
    p.friction = TABLE_FRICTION
    p.log_first = TABLE_LOG_FIRST + length
    p.log_step = TABLE_LOG_STEP
    p.gentle = 1.0
    shift = (force, length, 0.0, length, 0.0, 0.0, 0.0, stiffness)
    p.table = [[value + add for value, add in zip(line, shift)] for line in TABLE_ROWS]
    p.shapes = TABLE_SHAPES
    return p


def out_of_range(m, radius, friction, h):
    """What lies outside of the table at the indentation h > 0: a sum of 2 mu, 64 h/R, 128 another material."""
    outside = 0
    if not alike(friction, TABLE_FRICTION):
        outside |= 2
    if not h / radius <= TABLE_DEEPEST * (1.0 + 1e-9):
        outside |= 64
    if not is_the_material(m):
        outside |= 128
    return outside


