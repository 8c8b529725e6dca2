"""Tables of results, for every library that reads Arrow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _native

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


class Table:
    """A table of results. pandas, polars, pyarrow and DuckDB take it as it is, without copies where they can.

    >>> import trainsafe
    >>> table = trainsafe.analyze("trains/ore-train.toml").couplers
    >>> table.columns[:3], len(table) > 100
    (['scenario', 'broken_coupler', 'coupler'], True)
    """

    def __init__(self, native: _native.Table) -> None:
        self._native = native

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        return self._native.__arrow_c_stream__(requested_schema)

    def __len__(self) -> int:
        return len(self._native)

    @property
    def columns(self) -> list[str]:
        """Names of the columns; units are in the names, as in ``result.json``."""
        return self._native.columns

    def to_dict(self) -> dict[str, list[Any]]:
        """The columns as lists; ``None`` where there is no value."""
        return {name: values for name, _, values in self._native.lists()}

    def to_arrow(self) -> pyarrow.Table:
        import pyarrow

        return pyarrow.table(self)

    def to_pandas(self) -> pandas.DataFrame:
        import pandas

        if hasattr(pandas.DataFrame, "from_arrow"):
            return pandas.DataFrame.from_arrow(self)
        return self.to_arrow().to_pandas()

    def to_polars(self) -> polars.DataFrame:
        import polars

        return polars.DataFrame(self)

    def __repr__(self) -> str:
        return f"<trainsafe.Table: {len(self)} rows, {len(self.columns)} columns>"

    def __reduce__(self) -> tuple[object, ...]:
        return _table, (self._native.lists(),)


def _table(lists: list[tuple[str, str, list[Any]]]) -> Table:
    return Table(_native.Table.of_lists(lists))
