<?xml version="1.0" encoding="utf-8"?>
<!-- An invented house with a gabled roof and a passage, 3 m wide and high, that a gate closes at its back. -->
<core:CityModel xmlns:core="http://www.opengis.net/citygml/2.0" xmlns:bldg="http://www.opengis.net/citygml/building/2.0" xmlns:gml="http://www.opengis.net/gml">
  <gml:boundedBy>
    <gml:Envelope srsName="EPSG:32632" srsDimension="3">
      <gml:lowerCorner>690000.25 5335000.5 512.125</gml:lowerCorner>
      <gml:upperCorner>690010.25 5335006.5 519.125</gml:upperCorner>
    </gml:Envelope>
  </gml:boundedBy>
  <core:cityObjectMember>
    <bldg:Building gml:id="gatehouse">
      <bldg:lod1MultiSurface><gml:MultiSurface><gml:surfaceMember>
        <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>689999.250 5334999.500 521.125 690011.250 5334999.500 521.125 690011.250 5335007.500 521.125 689999.250 5335007.500 521.125 689999.250 5334999.500 521.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
      </gml:surfaceMember></gml:MultiSurface></bldg:lod1MultiSurface>
      <bldg:boundedBy>
        <bldg:WallSurface gml:id="front">
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon gml:id="front_polygon"><gml:exterior><gml:LinearRing><gml:posList>690000.250 5335000.500 512.125 690003.750 5335000.500 512.125 690003.750 5335000.500 515.125 690006.750 5335000.500 515.125 690006.750 5335000.500 512.125 690010.250 5335000.500 512.125 690010.250 5335000.500 517.125 690000.250 5335000.500 517.125 690000.250 5335000.500 512.125</gml:posList></gml:LinearRing></gml:exterior><gml:interior><gml:LinearRing><gml:posList>690001.250 5335000.500 514.125 690001.250 5335000.500 515.125 690002.250 5335000.500 515.125 690002.250 5335000.500 514.125 690001.250 5335000.500 514.125</gml:posList></gml:LinearRing></gml:interior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
          <bldg:opening>
            <bldg:Window gml:id="pane">
              <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
                <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690002.250 5335000.500 514.125 690002.250 5335000.500 515.125 690001.250 5335000.500 515.125 690001.250 5335000.500 514.125 690002.250 5335000.500 514.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
              </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
            </bldg:Window>
          </bldg:opening>
        </bldg:WallSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:WallSurface gml:id="back">
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon gml:id="back_polygon"><gml:exterior><gml:LinearRing><gml:posList>690000.250 5335006.500 517.125 690010.250 5335006.500 517.125 690010.250 5335006.500 512.125 690006.750 5335006.500 512.125 690006.750 5335006.500 515.125 690003.750 5335006.500 515.125 690003.750 5335006.500 512.125 690000.250 5335006.500 512.125 690000.250 5335006.500 517.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:WallSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:WallSurface gml:id="gate">
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon gml:id="gate_polygon"><gml:exterior><gml:LinearRing><gml:posList>690003.750 5335006.500 512.125 690003.750 5335006.500 515.125 690006.750 5335006.500 515.125 690006.750 5335006.500 512.125 690003.750 5335006.500 512.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:WallSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:WallSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690000.250 5335006.500 512.125 690000.250 5335000.500 512.125 690000.250 5335000.500 517.125 690000.250 5335003.500 519.125 690000.250 5335006.500 517.125 690000.250 5335006.500 512.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:WallSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:WallSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690010.250 5335000.500 512.125 690010.250 5335006.500 512.125 690010.250 5335006.500 517.125 690010.250 5335003.500 519.125 690010.250 5335000.500 517.125 690010.250 5335000.500 512.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:WallSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:WallSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690003.750 5335000.500 512.125 690003.750 5335006.500 512.125 690003.750 5335006.500 515.125 690003.750 5335000.500 515.125 690003.750 5335000.500 512.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:WallSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:WallSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690006.750 5335006.500 512.125 690006.750 5335000.500 512.125 690006.750 5335000.500 515.125 690006.750 5335006.500 515.125 690006.750 5335006.500 512.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:WallSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:RoofSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690000.250 5335000.500 517.125 690010.250 5335000.500 517.125 690010.250 5335003.500 519.125 690000.250 5335003.500 519.125 690000.250 5335000.500 517.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:RoofSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:RoofSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690010.250 5335006.500 517.125 690000.250 5335006.500 517.125 690000.250 5335003.500 519.125 690010.250 5335003.500 519.125 690010.250 5335006.500 517.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:RoofSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:OuterCeilingSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690003.750 5335000.500 515.125 690003.750 5335006.500 515.125 690006.750 5335006.500 515.125 690006.750 5335000.500 515.125 690003.750 5335000.500 515.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:OuterCeilingSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:GroundSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690000.250 5335000.500 512.125 690000.250 5335006.500 512.125 690003.750 5335006.500 512.125 690003.750 5335000.500 512.125 690000.250 5335000.500 512.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:GroundSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:GroundSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690006.750 5335000.500 512.125 690006.750 5335006.500 512.125 690010.250 5335006.500 512.125 690010.250 5335000.500 512.125 690006.750 5335000.500 512.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:GroundSurface>
      </bldg:boundedBy>
      <bldg:boundedBy>
        <bldg:ClosureSurface>
          <bldg:lod3MultiSurface><gml:MultiSurface><gml:surfaceMember>
            <gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>690003.750 5335000.500 512.125 690006.750 5335000.500 512.125 690006.750 5335000.500 515.125 690003.750 5335000.500 515.125 690003.750 5335000.500 512.125</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>
          </gml:surfaceMember></gml:MultiSurface></bldg:lod3MultiSurface>
        </bldg:ClosureSurface>
      </bldg:boundedBy>
    </bldg:Building>
  </core:cityObjectMember>
</core:CityModel>
