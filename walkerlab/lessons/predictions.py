"""Predictions, typed or chosen before a run, and their comparison with the result."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from walkerlab.lessons.exercises import LessonError
from walkerlab.lessons.feedback import COMPARED, EMPTY, NOT_YET, PREDICTED, Bar, Feedback
from walkerlab.settings.values import short_repr
from walkerlab.view.plots.tables import format_value
from walkerlab.widgets.questions import Item, Questions, Reply

NOTHING_PREDICTED = "No prediction yet: replace ... with your prediction and run the cell again."


@dataclass(frozen=True)
class Prediction:
    """A prediction.

    Attributes:
        value: A number or a text; None if there is no prediction.
        unit: Unit of a number; "" if it has none.
        is_chosen: Whether it was chosen from several options.
    """

    value: Any
    unit: str = ""
    is_chosen: bool = False


_predictions: dict[str, Prediction] = {}
"""Last predictions in this kernel, by number."""


def predict(number: str, value: Any, unit: str = "") -> Feedback:
    """Remember a prediction, for ``compare`` after the run.

    Args:
        number: Number of the prediction, such as "03.1".
        value: Predicted number, in ``unit``; or a text. ``...`` if there is no prediction yet.
        unit: Unit of the number.

    Returns:
        The prediction, as a notebook displays it.
    """
    value = _to_plain(value)
    _predictions[number] = Prediction(None, unit)
    if value is None or value is ... or value == "":
        return Feedback(EMPTY, NOTHING_PREDICTED)
    if unit and not _is_number(value):
        return Feedback(NOT_YET, f"Write a number without quotes and without the unit {unit}, then run the cell again.")
    if not (_is_number(value) or isinstance(value, str | bool)):
        return Feedback(NOT_YET, f"{short_repr(value)} is not a prediction. Write a number, or a word in quotes.")
    _predictions[number] = Prediction(value, unit)
    return Feedback(PREDICTED, f"{_write(value, unit)}.", "Now run the next cells, and compare.")


def choose(number: str, options: Sequence[str]) -> Questions:
    """Return a row of buttons, one of which is the prediction, for ``compare`` after the run.

    Args:
        number: Number of the prediction, such as "03.1".
        options: Texts of the buttons, at least 2.

    Raises:
        LessonError: If there are fewer than 2 options, or an option is not a text.
    """
    texts: list[Any] = list(options) if not isinstance(options, str) else []
    if len(texts) < 2 or not all(isinstance(text, str) for text in texts):
        raise LessonError(f"the options are {short_repr(options)}; they must be a list of at least 2 texts.")

    def remember(_: int, choice: str) -> Reply:
        _predictions[number] = Prediction(choice, is_chosen=True)
        return Reply("chosen", f"Your prediction: {choice}.")

    earlier = _predictions.get(number, Prediction(None))
    widget = Questions([Item("Your prediction?", tuple(texts))], remember, title="prediction", is_row=True)
    if earlier.is_chosen and earlier.value in texts:
        widget.answers = [earlier.value]
    else:
        _predictions[number] = Prediction(None, is_chosen=True)
    return widget


def compare(number: str, measured: Any, unit: str = "") -> Feedback:
    """Compare a prediction with the result of a run.

    Args:
        number: Number of the prediction, as for ``predict`` or ``choose``.
        measured: The result: a number in the unit of the prediction, or one of the options.
        unit: Unit of the result, if ``predict`` was not given any.

    Returns:
        Prediction and result, as a notebook displays them.
    """
    prediction = _predictions.get(number, Prediction(None))
    unit = prediction.unit or unit
    measured = _to_plain(measured)
    if measured is None or measured is ...:
        return Feedback(EMPTY, "There is no result yet: run the cells above, then this cell again.")
    result = _write(measured, unit)
    predicted = prediction.value
    if predicted is None:
        verb = "choose one of the buttons" if prediction.is_chosen else "write a prediction"
        return Feedback(COMPARED, f"The result is {result}. You made no prediction; next time, {verb} before the run.")
    if not (_is_number(predicted) and _is_number(measured)):
        verdict = "as you predicted" if predicted == measured else "not what you predicted"
        verb = "chose" if prediction.is_chosen else "predicted"
        return Feedback(COMPARED, f"You {verb} {_write(predicted, unit)}; the result is {result}, {verdict}.")
    difference = measured - predicted
    change = (
        f"{_write(abs(difference), unit)} {'more' if difference > 0 else 'less'}"
        if difference
        else "exactly as predicted"
    )
    text = f"You predicted {_write(predicted, unit)}; the run gave {result} ({change})."
    return Feedback(COMPARED, text, bars=_bars({"predicted": predicted, "measured": measured}, unit))


def _bars(values: dict[str, float], unit: str) -> tuple[Bar, ...]:
    """Return the values as bars; none if a value is negative or infinite, or all are zero."""
    longest = max(values.values())
    if min(values.values()) < 0 or not 0 < longest < float("inf"):
        return ()
    return tuple(Bar(label, _write(value, unit), 100 * value / longest) for label, value in values.items())


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _to_plain(value: Any) -> Any:
    """Convert a number of numpy to a number of Python; other objects are returned as they are."""
    return value.item() if hasattr(value, "item") and getattr(value, "size", 1) == 1 else value


def _write(value: Any, unit: str) -> str:
    if _is_number(value):
        is_one = abs(value) == 1 and unit.isalpha() and len(unit) > len("s")  # "1 robot", and still "1 s"
        return format_value(float(value), unit.removesuffix("s") if is_one else unit)
    return value if isinstance(value, str) else short_repr(value)
