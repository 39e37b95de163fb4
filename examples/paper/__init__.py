"""The figures of Walker & Leine (2019), redrawn with their data and checks of what they state.

A file per figure, in `laws` (§2 and §3), `instability` (§4) and `experiments` (§5), each a script
of the gallery. All use the public interface only. ``make figures`` draws all of them.
"""
