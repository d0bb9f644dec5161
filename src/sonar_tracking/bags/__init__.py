"""Rosbags and recorded data: write, read, recover, import. Nothing here needs ROS."""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "Bag",
    "BagTopic",
    "BagWriter",
    "ContactSensor",
    "import_contacts",
    "import_samples",
    "import_wav",
    "read_bag",
    "read_pings",
    "records_of",
    "repair_bag",
    "topics_of_type",
]

if TYPE_CHECKING:
    from sonar_tracking.bags.importers.import_contacts import (
        ContactSensor,
        import_contacts,
        read_pings,
    )
    from sonar_tracking.bags.importers.import_samples import import_samples
    from sonar_tracking.bags.importers.import_wav import import_wav
    from sonar_tracking.bags.storage.bag_records import records_of, topics_of_type
    from sonar_tracking.bags.storage.reader import Bag, BagTopic, read_bag
    from sonar_tracking.bags.storage.repair import repair_bag
    from sonar_tracking.bags.storage.writer import BagWriter
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "importers.import_contacts": ["ContactSensor", "import_contacts", "read_pings"],
            "importers.import_samples": ["import_samples"],
            "importers.import_wav": ["import_wav"],
            "storage.bag_records": ["records_of", "topics_of_type"],
            "storage.reader": ["Bag", "BagTopic", "read_bag"],
            "storage.repair": ["repair_bag"],
            "storage.writer": ["BagWriter"],
        },
    )
