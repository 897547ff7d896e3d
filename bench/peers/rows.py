"""What is compared: one row a problem and guess, with the program for the peers and the case for ntg."""

from dataclasses import dataclass

from .problems import agents, flight, missiles, small


@dataclass
class Row:
    name: str
    program: object  # Makes the peers' program.
    ask: dict  # What bench/server is asked.
    reference: float  # The objective of this very discretisation.
    ipopt: float = 0  # Targets: how many times slower the peers should be.
    sqp: float = 0
    ripopt: float = 15
    scalar: bool = False  # Small enough for gcc on one big expression.
    control: bool = False  # A problem that python-control can state.

    def chosen(self, only):
        return not only or any(self.name.lower().startswith(word.lower()) for word in only)


ROUTES = {"a": flight.ROUTE_A, "b": flight.ROUTE_B}
INTERVALS = {
    16: 128.318602,
    32: 128.339285,
    64: 128.349529,
    128: 128.356333,
    256: 128.360004,
    512: None,
}


def route(way):
    return [list(flight.START), list(way), list(flight.TARGET)]


def small_rows():
    yield Row("vdp", small.van_der_pol, {"case": "van_der_pol"}, 1.70221426283, ipopt=20, sqp=5, scalar=True)
    yield Row("car", small.kinematic_car, {"case": "kinematic_car"}, 2.45758114194949, ipopt=20, sqp=5, scalar=True, control=True)


def flight_rows():
    kinds = [
        ("B1", "b1", flight.b1, {}, 128.252905291),
        ("B2", "b2", flight.b2, {}, 130.907227498),
        ("B2cos", "b2_cosine", flight.b2, {"cosine": True}, 130.907227498),
        ("B3", "b3", flight.b3, {}, 128.347970733),
        ("B3cos", "b3_cosine", flight.b3, {"cosine": True}, 128.347970733),
    ]
    for name, case, make, options, reference in kinds:
        for letter, way in ROUTES.items():
            program = lambda make=make, options=options, way=way: make(route=[way], **options)
            ask = {"case": case, "route": route(way)}
            yield Row(f"{name}/{letter}", program, ask, reference, ipopt=25, sqp=0 if name in ("B2", "B3") else 1)
    for intervals, reference in INTERVALS.items():
        program = lambda intervals=intervals: flight.b1(intervals=intervals)
        ask = {"case": "b1", "intervals": intervals}
        yield Row(f"B1/l={intervals}", program, ask, reference, ipopt=20 if intervals >= 32 else 25)


FLEETS = {
    "free": ("fleet", lambda n: agents.fleet(n, "free"), (193.7759761223, 383.2192231937, 791.6563412117)),
    "equal": ("fleet_equal", lambda n: agents.fleet(n, "equal"), (193.8398442096, 383.8418446998, 796.3758747681)),
    "later": ("fleet_later", lambda n: agents.fleet(n, "later"), (194.1624015570, 386.9907816624, 832.2554079138)),
    "apart": ("fleet_apart", agents.separated, (193.9769689597, 384.3539676639, 798.4461502683)),
}


def fleet_rows():
    for n_at, n in enumerate((2, 4, 8)):
        for name, (case, make, references) in FLEETS.items():
            program = lambda make=make, n=n: make(n)
            ask = {"case": f"{case}_{n}"}
            yield Row(f"C{n}/{name}", program, ask, references[n_at], ipopt=25, sqp=1 if n < 8 else 0)


def missile_rows():
    for name, y_via, reference in (("right", 20.0, 95.97490559), ("left", 0.0, 105.65148376)):
        ask = {"case": f"intercept_{name}"}
        yield Row(f"D1/{name}", lambda y_via=y_via: missiles.intercept(y_via), ask, reference, ipopt=15)
    for a_max, reference in ((300, 18.7991136), (30, 18.8428878)):
        ask = {"case": f"boost_coast_{a_max}"}
        yield Row(f"D2/{a_max}", lambda a_max=a_max: missiles.boost_coast(a_max), ask, reference, ipopt=15)


def all_rows():
    return [*small_rows(), *flight_rows(), *fleet_rows(), *missile_rows()]
