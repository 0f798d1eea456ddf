# SPDX-License-Identifier: Apache-2.0
"""Why a model has no solution, in its own components."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from perp.pyomo._model import CompiledModel
from perp.pyomo._rows import Auxiliary


@dataclass
class Answer:
    kind: str  #: "conflict", "repair", "residual", "structure", "mirror", "family" or "start"
    proven: bool  #: False: likely
    text: str
    constraints: list[Any]  #: and conditions
    variables: list[Any]

    def __str__(self) -> str:
        return f"{'proven' if self.proven else 'likely'}: {self.text}"


@dataclass
class Explanation:
    """The answers, the first one first; as text by print()."""

    status: str
    message: str
    answers: list[Answer]

    @property
    def constraints(self) -> list[Any]:
        """Of the first answer."""
        return self.answers[0].constraints if self.answers else []

    @property
    def variables(self) -> list[Any]:
        """Of the first answer."""
        return self.answers[0].variables if self.answers else []

    def __str__(self) -> str:
        lines = [f"{k}. {answer}" for k, answer in enumerate(self.answers, 1)]
        return "\n".join([f"{self.status}: {self.message}", *lines])


def explanation_of(compiled: CompiledModel, document: dict[str, Any]) -> Explanation:
    rows = {row.name: row.component for row in compiled.rows}
    columns = {variable.name: variable for variable in compiled.columns if not isinstance(variable, Auxiliary)}
    answers = [
        Answer(
            kind=answer["kind"],
            proven=answer["proven"],
            text=answer["text"],
            constraints=[rows[name] for name in answer["rows"] if name in rows],
            variables=[columns[name] for name in answer["variables"] if name in columns],
        )
        for answer in document["answers"]
    ]
    return Explanation(document["status"], document["message"], answers)
