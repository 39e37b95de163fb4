"""The paper's two simulations and a round trip, with the numbers they are checked against.

`belt` is the limit cycle of [WL19] Fig. 17, `sliding` the paths of Fig. 27 with the laws of
`table1`; `round_trip` leads from synthetic forces to a law, and from the law to a path that is
compared with that of a `film`. ``asperity demo`` runs them, through the public interface.
"""

from asperity.demo import belt, film, round_trip, sliding, table1
from asperity.demo.checks import Check

__all__ = ["Check", "belt", "film", "round_trip", "sliding", "table1"]
