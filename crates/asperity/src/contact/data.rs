//! Contact problems as data that are written and read with serde.
//!
//! A problem is a table with its different `laws`, its `contacts` (the number of the `law`, if there is friction, and the
//! `normal_force` where that is given), `free_velocity` b, `restitution` e γ_B, and the `delassus` operator: a table with the `type`
//! `Dense` (`rows`), `Blocks` (`sizes`, `neighbours`, `values`: block after block, row by row) or `Factored` (`mass` and
//! `directions` as compressed rows, and the `blocks`). What is read goes through the checked constructors. An operator
//! that is known by its products cannot be written.

use nalgebra::DMatrix;
use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{BlockMatrix, ContactProblem, Csr, Delassus, Factored, IntoDelassus};
use crate::argument::{ArgumentError, length, refuse};
use crate::law::Law;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProblemData {
    free_velocity: Vec<f64>,
    restitution: Vec<f64>,
    contacts: Vec<ContactData>,
    laws: Vec<Law>,
    delassus: DelassusData,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactData {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    law: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    normal_force: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(tag = "type", deny_unknown_fields)]
enum DelassusData {
    Dense { rows: Vec<Vec<f64>> },
    Blocks(BlockData),
    Factored { mass: CsrData, directions: CsrData, blocks: BlockData },
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BlockData {
    sizes: Vec<usize>,
    neighbours: Vec<Vec<usize>>,
    values: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CsrData {
    shape: (usize, usize),
    starts: Vec<usize>,
    indices: Vec<usize>,
    values: Vec<f64>,
}

impl From<&BlockMatrix> for BlockData {
    fn from(blocks: &BlockMatrix) -> Self {
        let contacts = 0..blocks.contacts();
        Self {
            sizes: contacts.clone().map(|i| blocks.size(i)).collect(),
            neighbours: contacts.map(|i| blocks.neighbours(i).to_vec()).collect(),
            values: blocks.values().to_vec(),
        }
    }
}

impl TryFrom<BlockData> for BlockMatrix {
    type Error = ArgumentError;

    fn try_from(data: BlockData) -> Result<Self, ArgumentError> {
        let mut blocks = Self::from_pattern(&data.sizes, &data.neighbours)?;
        length("delassus", blocks.values().len(), data.values.len())?;
        blocks.values_mut().copy_from_slice(&data.values);
        Ok(blocks)
    }
}

impl From<&Csr> for CsrData {
    fn from(csr: &Csr) -> Self {
        Self {
            shape: (csr.rows(), csr.columns()),
            starts: csr.starts().to_vec(),
            indices: csr.indices().to_vec(),
            values: csr.values().to_vec(),
        }
    }
}

impl CsrData {
    fn csr(self, argument: &'static str) -> Result<Csr, ArgumentError> {
        let Self { shape: (rows, columns), starts, indices, values } = self;
        Csr::new(rows, columns, starts, indices, values).map_err(|error| error.named(argument))
    }
}

impl TryFrom<&Delassus> for DelassusData {
    type Error = ArgumentError;

    fn try_from(delassus: &Delassus) -> Result<Self, ArgumentError> {
        Ok(match delassus {
            Delassus::Blocks(blocks) if blocks.is_full() => {
                let matrix = delassus.to_dense();
                let rows = matrix.row_iter().map(|row| row.iter().copied().collect());
                Self::Dense { rows: rows.collect() }
            }
            Delassus::Blocks(blocks) => Self::Blocks(blocks.into()),
            Delassus::Factored(factored) => Self::Factored {
                mass: factored.mass().into(),
                directions: factored.directions().into(),
                blocks: factored.blocks().into(),
            },
            Delassus::MatrixFree(_) => {
                return refuse("delassus", "must have entries: products are code and not written");
            }
        })
    }
}

impl IntoDelassus for DelassusData {
    fn into_delassus(self, sizes: &[usize]) -> Result<Delassus, ArgumentError> {
        match self {
            DelassusData::Dense { rows } => {
                let n = rows.len();
                if rows.iter().any(|row| row.len() != n) {
                    return refuse("delassus", "must have as many columns as rows");
                }
                DMatrix::from_fn(n, n, |i, j| rows[i][j]).into_delassus(sizes)
            }
            DelassusData::Blocks(blocks) => BlockMatrix::try_from(blocks)?.into_delassus(sizes),
            DelassusData::Factored { mass, directions, blocks } => {
                let (mass, directions) = (mass.csr("mass")?, directions.csr("directions")?);
                Factored::with_blocks(mass, directions, blocks.try_into()?)?.into_delassus(sizes)
            }
        }
    }
}

impl TryFrom<&ContactProblem> for ProblemData {
    type Error = ArgumentError;

    fn try_from(problem: &ContactProblem) -> Result<Self, ArgumentError> {
        let (mut laws, mut contacts) = (Vec::<Law>::new(), Vec::new());
        for rows in problem.contacts() {
            let normal_force = rows.normal.prescribed();
            if let Law::Zero(_) = rows.law {
                contacts.push(ContactData { law: None, normal_force });
                continue;
            }
            let known = laws.iter().rposition(|law| law.is_the_same(&rows.law));
            let law = known.unwrap_or_else(|| {
                laws.push(rows.law.clone());
                laws.len() - 1
            });
            contacts.push(ContactData { law: Some(law), normal_force });
        }
        Ok(Self {
            free_velocity: problem.free_velocity().to_vec(),
            restitution: problem.restitution().to_vec(),
            contacts,
            laws,
            delassus: problem.delassus().try_into()?,
        })
    }
}

impl TryFrom<ProblemData> for ContactProblem {
    type Error = ArgumentError;

    fn try_from(data: ProblemData) -> Result<Self, ArgumentError> {
        let ProblemData { free_velocity, restitution, contacts, laws, delassus } = data;
        let contacts: Option<Vec<_>> = contacts
            .iter()
            .map(|contact| {
                let law =
                    contact.law.map_or_else(|| Some(Law::frictionless()), |k| laws.get(k).cloned());
                Some((law?, contact.normal_force.into()))
            })
            .collect();
        let Some(contacts) = contacts else {
            return refuse("contacts", "must have the numbers of laws that there are");
        };
        // Coefficients of one leave the terms as they are.
        let ones = vec![1.0; contacts.len()];
        Self::new(delassus, free_velocity, contacts)?.with_restitution(&ones, &ones, &restitution)
    }
}

impl Serialize for ContactProblem {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        ProblemData::try_from(self).map_err(S::Error::custom)?.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for ContactProblem {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::try_from(ProblemData::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}
