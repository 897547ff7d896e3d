"""What is compared: one row a problem and guess, with the program for the peers and the case for ntg."""

from dataclasses import dataclass, field

from .problems import agents, flight, small


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
    check_only: list = field(default_factory=list)

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
    yield Row("car", small.kinematic_car, {"case": "kinematic_car"}, 2.45758114194949, ipopt=20, sqp=5, scalar=True)


def flight_rows():
    kinds = [
        ("B1", "b1", flight.b1, {}, 128.252905291, True),
        ("B2", "b2", flight.b2, {}, 130.907227498, False),
        ("B2cos", "b2_cosine", flight.b2, {"cosine": True}, 130.907227498, False),
    ]
    for name, case, make, options, reference, scalar in kinds:
        for letter, way in ROUTES.items():
            program = lambda make=make, options=options, way=way: make(route=[way], **options)
            ask = {"case": case, "route": route(way)}
            yield Row(f"{name}/{letter}", program, ask, reference, ipopt=25, scalar=scalar, sqp=1 if name != "B2" else 0)
    for intervals, reference in INTERVALS.items():
        program = lambda intervals=intervals: flight.b1(intervals=intervals)
        ask = {"case": "b1", "intervals": intervals}
        yield Row(f"B1/l={intervals}", program, ask, reference, ipopt=20 if intervals >= 32 else 25)


def all_rows():
    return [*small_rows(), *flight_rows()]
