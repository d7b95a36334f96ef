class Parameters:
    """A pair of materials, shared by its contacts."""

    __slots__ = ("radius", "effective_modulus", "friction", "log_first", "log_step", "gentle", "table", "shapes")


class State:
    """The memory of a contact; as constructed, that before first contact."""

    __slots__ = ("h", "h_max", "approach", "reach", "x", "sheared", "reversed", "deflection")
    _LAYOUT = struct.Struct("<%dd" % (7 + 2 * SLIDERS))

    def __init__(self, h=0.0, h_max=0.0, approach=0.0, reach=0.0, x=0.0, sheared=0.0, reversed=0.0, deflection=None):
        self.h = h
        self.h_max = h_max
        self.approach = approach
        self.reach = reach
        self.x = x
        self.sheared = sheared
        self.reversed = reversed
        self.deflection = [[0.0, 0.0] for _ in range(SLIDERS)] if deflection is None else deflection

    def copy(self):
        """An independent copy."""
        return State(self.h, self.h_max, self.approach, self.reach, self.x, self.sheared, self.reversed, [list(q) for q in self.deflection])

    def is_sound(self):
        """Whether it is a state that an update may have left: all its numbers finite, and each within its bounds."""
        numbers = [self.h, self.approach, self.h_max, self.reach] + [v for q in self.deflection for v in q]
        return (all(math.isfinite(v) for v in numbers) and self.h_max >= 0.0 and self.reach >= 0.0 and 0.0 <= self.x <= MOST
                and 0.0 <= self.sheared <= MOST and 0.0 <= self.reversed <= 1.0)

    def to_bytes(self):
        """The memory as bytes."""
        return self._LAYOUT.pack(self.h, self.h_max, self.approach, self.reach, self.x, self.sheared, self.reversed, *(v for q in self.deflection for v in q))

    @classmethod
    def from_bytes(cls, data):
        """The memory from its bytes."""
        v = cls._LAYOUT.unpack(data)
        return cls(v[0], v[1], v[2], v[3], v[4], v[5], v[6], [[v[7 + 2 * i], v[8 + 2 * i]] for i in range(SLIDERS)])


class Response:
    """The answer of an increment."""

    __slots__ = ("f_n", "f_t", "df_t_ddelta", "df_n_dh", "df_n_ddelta", "a")

    def __init__(self):
        self.f_n = 0.0
        self.f_t = [0.0, 0.0]
        self.df_t_ddelta = [[0.0, 0.0], [0.0, 0.0]]
        self.df_n_dh = 0.0
        self.df_n_ddelta = [0.0, 0.0]
        self.a = 0.0


