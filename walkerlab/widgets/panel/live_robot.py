"""A playground beside an editor: a change to the genome in either one is applied to the other."""

from typing import Any

from walkerlab.settings.settings import Settings
from walkerlab.widgets.editor import Editor
from walkerlab.widgets.playground import Playground
from walkerlab.widgets.repairs import format_genome, parse_within


def open_live_robot(editor: Editor, name: str, settings: Settings) -> Playground:
    """Return a playground of the robot in an editor; its page opens when the playground is displayed.

    Args:
        editor: Editor with a valid genome; it is synchronised with the playground until the playground is closed.
        name: Label of the robot.
        settings: Settings of the world.
    """
    genome: Any = editor.genome
    name = f"edited {name}" if editor.is_edited else name
    playground = Playground({name: genome}, settings)
    playground.opens_at_once = True

    def follow_editor(change: Any) -> None:
        if change.new is not None and change.new != parse_within(playground.gene_text, settings.robot):
            playground.gene_text = str(change.new)

    def follow_playground(change: Any) -> None:
        genome = parse_within(change.new, settings.robot)
        if genome is not None and genome != editor.genome:
            editor.text = format_genome(genome)

    def stop_following(change: Any) -> None:
        if change.new is None:  # the playground was closed
            editor.unobserve(follow_editor, "genome")

    editor.observe(follow_editor, "genome")
    playground.observe(follow_playground, "gene_text")
    playground.observe(stop_following, "comm")
    return playground
