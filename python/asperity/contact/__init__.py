"""Contact problems as data: problem, solution, certificate, files."""

from asperity.contact.certificate import Certificate as Certificate
from asperity.contact.certificate import Infeasibility as Infeasibility
from asperity.contact.problem import ContactProblem
from asperity.contact.solution import ContactSolution as ContactSolution
from asperity.contact.solution import Island as Island
from asperity.contact.solution import LocalSolution as LocalSolution
from asperity.contact.solution import Stage as Stage
from asperity.contact.stepper import ContactStepper
from asperity.contact.stepper import StepSolution as StepSolution

__all__ = [
    "ContactProblem",
    "ContactStepper",
]
