"""What notebooks show."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["summary_table", "table"]

_SHOWN = ("F_N0", "a0", "h0", "F_N_slip", "F_T_max", "F_T_max_limit", "delta_T_slip", "k_T0")


def table(rows: Sequence[tuple[str, ...]], head: tuple[str, ...] = ()) -> str:
    """Rows of text as a table."""

    def line(row: tuple[str, ...], kind: str) -> str:
        return "<tr>" + "".join(f"<{kind}>{html.escape(cell)}</{kind}>" for cell in row) + "</tr>"

    top = f"<thead>{line(head, 'th')}</thead>" if head else ""
    return f"<table>{top}<tbody>{''.join(line(row, 'td') for row in rows)}</tbody></table>"


def summary_table(summary: Mapping[str, Any]) -> str:
    """The results of a run, with their errors."""
    rows = [("status", str(summary.get("status")), "")]
    for name in _SHOWN:
        value, error = summary.get(name), summary.get(f"{name}_error")
        if isinstance(value, (int, float)):
            share = f"+- {100 * error / abs(value):.1f} %" if isinstance(error, (int, float)) and value else ""
            rows.append((name, f"{value:.6g}", share))
    return table(rows)
