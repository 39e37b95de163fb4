"""Contact problems as data: problem, solution, certificate, files."""

from asperity.contact.certificate import Certificate, Infeasibility
from asperity.contact.problem import ContactProblem
from asperity.contact.solution import ContactSolution, Island, LocalSolution, Stage

__all__ = [
    "Certificate",
    "ContactProblem",
    "ContactSolution",
    "Infeasibility",
    "Island",
    "LocalSolution",
    "Stage",
]
